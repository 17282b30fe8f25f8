#pragma once
// A software GPU: what a program that embeds it includes. docs/embedding.md has an example.
//
// Stages of one's own are compiled into the user's program with the pipeline around them,
// so their bits hang on its flags: -ffp-contract=off and -fno-fast-math keep them, and the
// CMake target and the pkg-config package ask for both.

#include "raster/images/image.h"
#include "raster/images/sampler.h"
#include "raster/images/texel.h"
#include "raster/numbers/profile.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/pipeline/draw.h"
#include "raster/threads/parallel.h"
