#include "raster/pipeline/assemble_lanes.inl"
#include "raster/pipeline/block_lanes.inl"
#include "raster/pipeline/edge_lanes.inl"
#include "raster/pipeline/rasterize_lanes.inl"
