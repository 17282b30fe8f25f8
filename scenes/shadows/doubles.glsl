// Numbers of binary64 in textures of 32-bit words, the lower word of each first. Beside
// tools/gl/doubles_on_gl.h.
#extension GL_ARB_gpu_shader_fp64 : require

// Texel `number` of a list, which runs along the texture's rows.
uvec4 texel_of(usampler2D list, int number) {
  int width = textureSize(list, 0).x;
  return texelFetch(list, ivec2(number % width, number / width), 0);
}

dvec2 doubles_in(uvec4 texel) {
  return dvec2(packDouble2x32(texel.xy), packDouble2x32(texel.zw));
}
