// An OpenGL renderer, off screen: a hall of pillars. Built with WITH_DEPTH_OF_FIELD it gets
// softfocus's shaders as two more passes. Writes a PPM picture to standard output, and to
// the file of its first argument the RGBA16F texels that the picture was made from.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#ifdef WITH_DEPTH_OF_FIELD
#include <softfocus/dof.h>
#endif

namespace {

constexpr int kWidth = 320, kHeight = 200;

constexpr const char* kSceneVertices = R"(
const vec2 corners[4] = vec2[](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(1, 1));
flat out int pillar;
out float height;
void main() {  // of each pillar a strip of two triangles that faces the camera
  vec2 corner = corners[gl_VertexID];
  pillar = gl_InstanceID;
  height = corner.y;
  float depth = 8.0 - 0.5 * float(pillar);
  float x = (pillar % 2 == 0 ? -1.0 : 1.0) * (0.3 + 0.06 * float(pillar)) + (corner.x - 0.5) * 0.25;
  vec2 place = vec2(x, corner.y * 2.0 - 1.0);
  gl_Position = vec4(place * vec2(1.1, 1.76), depth - 0.2, depth);
}
)";

constexpr const char* kSceneFragments = R"(
flat in int pillar;
in float height;
out vec4 colour;
void main() {
  float band = float(int(height * 12.0) % 2);
  vec3 light = mix(vec3(0.05), vec3(0.4 + 0.04 * float(pillar), 0.5, 0.9 - 0.05 * float(pillar)), band);
  colour = vec4(light, 1.0);
#ifdef WITH_DEPTH_OF_FIELD
  colour.a = 1.0 / gl_FragCoord.w;
#endif
}
)";

GLuint link_program(const std::string& vertices, const std::string& fragments) {
#ifdef WITH_DEPTH_OF_FIELD
  const std::string header = "#version 400\n#define WITH_DEPTH_OF_FIELD\n";
#else
  const std::string header = "#version 400\n";
#endif
  const GLuint program = glCreateProgram();
  for (const bool is_vertex : {true, false}) {
    const std::string text = header + (is_vertex ? vertices : fragments);
    const char* const source = text.c_str();
    const GLuint shader = glCreateShader(is_vertex ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == 0) {
    std::string log(4096, '\0');
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    std::fprintf(stderr, "gl_renderer: %s\n", log.c_str());
  }
  return program;
}

struct Target {
  GLuint framebuffer = 0, colour = 0;
};

Target make_target(bool with_depth) {
  Target target;
  glGenFramebuffers(1, &target.framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glGenTextures(1, &target.colour);
  glBindTexture(GL_TEXTURE_2D, target.colour);
  glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA16F, kWidth, kHeight);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target.colour, 0);
  if (with_depth) {
    GLuint depth = 0;
    glGenRenderbuffers(1, &depth);
    glBindRenderbuffer(GL_RENDERBUFFER, depth);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, kWidth, kHeight);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
  }
  return target;
}

bool open_gl() {
  const EGLDisplay display =
      eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  if (!eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) return false;
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, nullptr);
  return eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
}

}  // namespace

int main(int argc, char** argv) {
  if (!open_gl()) return std::fputs("gl_renderer: no OpenGL\n", stderr), 1;
  GLuint vertex_array = 0;
  glGenVertexArrays(1, &vertex_array);
  glBindVertexArray(vertex_array);
  glViewport(0, 0, kWidth, kHeight);

  const GLuint scene_program = link_program(kSceneVertices, kSceneFragments);
  Target picture = make_target(true);
  glEnable(GL_DEPTH_TEST);
  glClearColor(0.02f, 0.03f, 0.05f, 100.0f);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glUseProgram(scene_program);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, 14);

  std::vector<std::uint16_t> halves(4 * kWidth * kHeight);
  if (argc > 1) glReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_HALF_FLOAT, halves.data());
#ifdef WITH_DEPTH_OF_FIELD
  const GLuint filter = link_program(std::string(softfocus::shader_text("fullscreen.vert")),
                                     std::string(softfocus::shader_text("two_pass.frag")));
  const softfocus::PixelCoc coc = softfocus::pixel_coc({85.0, 1.4, 4.0}, 30.0, kHeight, 2.0);
  glUseProgram(filter);
  glUniform1f(glGetUniformLocation(filter, "radius_at_infinity_px"), coc.radius_at_infinity_px);
  glUniform1f(glGetUniformLocation(filter, "focus_m"), coc.focus_m);
  glUniform1f(glGetUniformLocation(filter, "max_coc_px"), 8.0f);
  glUniform1f(glGetUniformLocation(filter, "leak"), 1.0f);
  glUniform1i(glGetUniformLocation(filter, "taps"), 7);
  glDisable(GL_DEPTH_TEST);
  for (const int pass : {0, 1}) {
    const Target target = make_target(false);
    glBindTexture(GL_TEXTURE_2D, picture.colour);
    glUniform2i(glGetUniformLocation(filter, "direction"), 1 - pass, pass);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    picture = target;
  }
#endif
  if (argc > 1) {
    std::FILE* file = std::fopen(argv[1], "wb");
    std::fwrite(halves.data(), 2, halves.size(), file);
    glReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_HALF_FLOAT, halves.data());
    std::fwrite(halves.data(), 2, halves.size(), file);
    std::fclose(file);
  }
  std::vector<unsigned char> bytes(3 * kWidth * kHeight);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, kWidth, kHeight, GL_RGB, GL_UNSIGNED_BYTE, bytes.data());
  std::printf("P6 %d %d 255\n", kWidth, kHeight);
  std::fwrite(bytes.data(), 1, bytes.size(), stdout);
}
