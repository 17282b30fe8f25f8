// With the blend function ONE, ONE: each pixel sums up what covered it.
flat in float count;
out vec4 sum;

void main() { sum = vec4(count, 0.0, 0.0, 0.0); }
