// A pixel of the frame before, moved. forward_reproject.vert has the rest.
flat in vec4 moved;

out vec4 colour;

void main() { colour = moved; }
