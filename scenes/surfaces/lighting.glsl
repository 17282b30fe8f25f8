// Light at a vertex: ambient, diffuse and specular after Blinn 1977. Beside
// scenes/surfaces/lighting.h, in the same order of operations: no pow() and no dot(), whose
// arithmetic drivers choose. MAX_LIGHTS, 1 or more, is defined by whoever compiles this.

uniform vec3 ambient_light;
uniform int light_count;  // 0 to MAX_LIGHTS
// The fourth component is 1 for a point light's place, 0 for a direction towards the light.
uniform vec4 light_position[MAX_LIGHTS];
uniform vec3 light_colour[MAX_LIGHTS];

uniform vec3 material_ambient;
uniform vec3 material_diffuse;
uniform vec3 material_specular;
uniform int material_shininess;
uniform float least_highlight;
uniform bool material_lit;

struct LitColour {
  vec3 base;  // what a texture multiplies
  vec3 specular;
};

float product_sum(vec3 a, vec3 b) {
  precise float sum = (a.x * b.x + a.y * b.y) + a.z * b.z;
  return sum;
}

vec3 unit(vec3 v) {
  float length = sqrt(product_sum(v, v));
  precise vec3 result = length > 0.0 ? v / length : vec3(0.0);
  return result;
}

// x^n by squaring, from the lowest bit of n up.
float whole_power(float x, int n) {
  precise float power = 1.0;
  precise float square = x;
  for (;;) {
    if ((n & 1) != 0) power *= square;
    n >>= 1;
    if (n == 0) return power;
    square *= square;
  }
}

LitColour light_point(vec3 point, vec3 normal, vec3 towards_eye) {
  if (!material_lit) return LitColour(material_diffuse, vec3(0.0));
  precise vec3 base = ambient_light * material_ambient;
  precise vec3 specular = vec3(0.0);
  for (int i = 0; i < light_count; ++i) {
    precise vec3 from_point = light_position[i].xyz - point;
    vec3 towards_light = unit(light_position[i].w != 0.0 ? from_point : light_position[i].xyz);
    float facing = product_sum(normal, towards_light);
    if (!(facing > 0.0)) continue;
    base += light_colour[i] * (material_diffuse * facing);
    precise vec3 between = towards_light + towards_eye;
    float highlight = product_sum(normal, unit(between));
    if (highlight >= least_highlight) {
      specular += light_colour[i] * (material_specular * whole_power(highlight, material_shininess));
    }
  }
  return LitColour(base, specular);
}
