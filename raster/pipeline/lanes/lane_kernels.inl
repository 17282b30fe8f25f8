#include "raster/pipeline/lanes/assemble_lanes.inl"
#include "raster/pipeline/lanes/block_lanes.inl"
#include "raster/pipeline/lanes/edge_lanes.inl"
#include "raster/pipeline/lanes/rasterize_lanes.inl"
