#pragma once
// What lanes.inl needs, compiled for every CPU.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "raster/lanes/isa.h"
#include "raster/numbers/fused.h"
#include "raster/numbers/half.h"

#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

// Vectors travel in registers only where a function is inlined. Builds in which speed is no
// matter may define it as `inline`.
#ifndef SOFTFOCUS_INLINE
#define SOFTFOCUS_INLINE [[gnu::always_inline]] inline
#endif
