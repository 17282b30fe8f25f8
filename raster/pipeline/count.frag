// Adds a triangle's amount to the pixels that it covers, with the blend function ONE, ONE.
// Beside raster/pipeline/draw.h.
flat in float count;
out vec4 sum;

void main() { sum = vec4(count, 0.0, 0.0, 0.0); }
