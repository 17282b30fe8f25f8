// Compiles the kernels of a file once for every vector unit. The scalar form and the kernels
// stand in one file, which includes itself:
//
//   #ifndef SOFTFOCUS_ISA
//   #include ...
//   #define SOFTFOCUS_KERNELS "dof/gather.cpp"               // this file
//   #include "raster/lanes/for_each_isa.inl"
//   ... the scalar form ...
//   ... SOFTFOCUS_KERNEL(isa, filter_row)(arguments) ...     // any isa but scalar
//   #else  // once a vector unit
//   void filter_row(...) { ... }
//   #endif
//
// The kernels come to lie in a namespace of the unit, softfocus::baseline, avx2 or avx512,
// beside lanes.inl's vectors of the unit's width. They may include other kernels (.inl) but no
// headers, which are compiled for every CPU and come before. They must not hold lambdas: clang
// compiles those without the unit's instructions.

#include "raster/lanes/isa.h"
#include "raster/lanes/lanes_headers.h"

#define SOFTFOCUS_ISA baseline
#define SOFTFOCUS_LANES 4
namespace softfocus::baseline {
#include "raster/lanes/lanes.inl"
#include SOFTFOCUS_KERNELS
}  // namespace softfocus::baseline
#undef SOFTFOCUS_ISA
#undef SOFTFOCUS_LANES

#if SOFTFOCUS_HAS_AVX

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma,f16c"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,f16c")
#endif
#define SOFTFOCUS_ISA avx2
#define SOFTFOCUS_LANES 8
namespace softfocus::avx2 {
#include "raster/lanes/lanes.inl"
#include SOFTFOCUS_KERNELS
}  // namespace softfocus::avx2
#undef SOFTFOCUS_ISA
#undef SOFTFOCUS_LANES
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#ifdef __clang__
#pragma clang attribute push(                                                    \
    __attribute__((target("avx2,fma,f16c,avx512f,avx512bw,avx512dq,avx512vl"))), \
    apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,f16c,avx512f,avx512bw,avx512dq,avx512vl")
#endif
#define SOFTFOCUS_ISA avx512
#define SOFTFOCUS_LANES 16
namespace softfocus::avx512 {
#include "raster/lanes/lanes.inl"
#include SOFTFOCUS_KERNELS
}  // namespace softfocus::avx512
#undef SOFTFOCUS_ISA
#undef SOFTFOCUS_LANES
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif
#undef SOFTFOCUS_KERNELS

/// The form of a kernel that was compiled for a unit.
#if SOFTFOCUS_HAS_AVX
#define SOFTFOCUS_KERNEL(isa, kernel)                              \
  ((isa) == ::softfocus::Isa::avx512 ? ::softfocus::avx512::kernel \
   : (isa) == ::softfocus::Isa::avx2 ? ::softfocus::avx2::kernel   \
                                     : ::softfocus::baseline::kernel)
#else
// A choice between two, so that a template is chosen by what is asked for, as above.
#define SOFTFOCUS_KERNEL(isa, kernel)                                  \
  ((isa) == ::softfocus::Isa::baseline ? ::softfocus::baseline::kernel \
                                       : ::softfocus::baseline::kernel)
#endif
