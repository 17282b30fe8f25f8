// Compiles the kernels of a file once for every vector unit. The scalar form and the kernels
// stand in one file, which includes itself:
//
//   #ifndef SOFTFOCUS_ISA
//   #include ...
//   #define SOFTFOCUS_KERNELS "dof/gather.cpp"               // this file
//   #include "raster/lanes/for_each_isa.inl"
//   ... the scalar form ...
//   ... SOFTFOCUS_KERNEL(isa, filter_row)(arguments) ...
//   #else  // once a vector unit
//   void filter_row(...) { ... }
//   #endif
//
// The kernels come to lie in a namespace of the unit, softfocus::baseline, avx2 or avx512,
// beside lanes.inl's vectors of the unit's width; and there in an inline one of the file's own, for
// files are compiled together. They may include other kernels (.inl) but no headers, which are
// compiled for every CPU and come before. They must not hold lambdas: clang compiles those without
// the unit's instructions.
//
// SOFTFOCUS_ONLY_LANES=4, 8 or 16 leaves out the other units: `scalar` and that one are there.

#include "raster/lanes/isa.h"
#include "raster/lanes/lanes_headers.h"

#define SOFTFOCUS_JOINED(a, b) a##b
#define SOFTFOCUS_NUMBERED(name, number) SOFTFOCUS_JOINED(name, number)
#define SOFTFOCUS_FILE SOFTFOCUS_NUMBERED(file, __COUNTER__)

#if SOFTFOCUS_HAS_LANES(4)
#define SOFTFOCUS_ISA baseline
#define SOFTFOCUS_LANES 4
namespace softfocus::baseline {
inline namespace SOFTFOCUS_FILE {
#include "raster/lanes/lanes.inl"
#include SOFTFOCUS_KERNELS
}  // namespace SOFTFOCUS_FILE
}  // namespace softfocus::baseline
#undef SOFTFOCUS_ISA
#undef SOFTFOCUS_LANES
#endif

#if SOFTFOCUS_HAS_LANES(8)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma,f16c"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,f16c")
#endif
#define SOFTFOCUS_ISA avx2
#define SOFTFOCUS_LANES 8
namespace softfocus::avx2 {
inline namespace SOFTFOCUS_FILE {
#include "raster/lanes/lanes.inl"
#include SOFTFOCUS_KERNELS
}  // namespace SOFTFOCUS_FILE
}  // namespace softfocus::avx2
#undef SOFTFOCUS_ISA
#undef SOFTFOCUS_LANES
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif

#if SOFTFOCUS_HAS_LANES(16)
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
inline namespace SOFTFOCUS_FILE {
#include "raster/lanes/lanes.inl"
#include SOFTFOCUS_KERNELS
}  // namespace SOFTFOCUS_FILE
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

/// The form of a kernel that was compiled for a unit. A choice in every build, so that a template
/// is chosen by what is asked for. Variadic for a template's commas.
#ifndef SOFTFOCUS_ONLY_LANES
#define SOFTFOCUS_KERNEL(isa, ...)                                      \
  ((isa) == ::softfocus::Isa::avx512 ? ::softfocus::avx512::__VA_ARGS__ \
   : (isa) == ::softfocus::Isa::avx2 ? ::softfocus::avx2::__VA_ARGS__   \
                                     : ::softfocus::baseline::__VA_ARGS__)
#else
#if SOFTFOCUS_ONLY_LANES == 16
#define SOFTFOCUS_ONLY_UNIT avx512
#elif SOFTFOCUS_ONLY_LANES == 8
#define SOFTFOCUS_ONLY_UNIT avx2
#else
#define SOFTFOCUS_ONLY_UNIT baseline
#endif
#define SOFTFOCUS_KERNEL(isa, ...)                                                   \
  ((isa) == ::softfocus::Isa::scalar ? ::softfocus::SOFTFOCUS_ONLY_UNIT::__VA_ARGS__ \
                                     : ::softfocus::SOFTFOCUS_ONLY_UNIT::__VA_ARGS__)
#endif
