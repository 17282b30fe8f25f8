#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "raster/shaders/shader_lanes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "raster/images/decoded_texture.h"
#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "raster/numbers/fused.h"
#include "raster/numbers/half.h"
#include "raster/shaders/shader_kernels.h"

#define SOFTFOCUS_KERNELS "raster/shaders/shader_lanes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr bool is_step(std::uint8_t op, StepOp of) { return op == static_cast<std::uint8_t>(of); }

bool steers(std::uint8_t op) { return op >= static_cast<std::uint8_t>(StepOp::jump); }

}  // namespace

std::uint32_t fold_shader_op(ShaderOp op, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                             std::uint32_t d) {
  constexpr std::size_t kLaneRoom = 16;
  alignas(64) std::array<std::uint32_t, 5 * kLaneRoom> memory;
  for (std::size_t i = 0; i < kLaneRoom; ++i) {
    memory[i] = a;
    memory[kLaneRoom + i] = b;
    memory[2 * kLaneRoom + i] = c;
    memory[3 * kLaneRoom + i] = d;
  }
  constexpr std::uint32_t kBytes = 4 * kLaneRoom;
  LaneStep step{
      .to = 4 * kBytes, .a = 0, .b = kBytes, .c = 2 * kBytes, .d = 3 * kBytes, .vectors = 1};
  LaneFrame frame{.memory = reinterpret_cast<std::byte*>(memory.data())};
  const Isa isa = Isa::baseline;
  SOFTFOCUS_KERNEL(isa, lane_function)(static_cast<std::uint8_t>(op))(step, frame);
  return memory[4 * kLaneRoom];
}

LaneProgram lane_program(const ShaderProgram& program, int lanes, Isa isa) {
  LaneProgram made;
  made.lanes = lanes;
  made.unit_lanes = isa == Isa::avx512 ? 16 : isa == Isa::avx2 ? 8 : 4;
#ifdef SOFTFOCUS_ONLY_LANES
  made.unit_lanes = SOFTFOCUS_ONLY_LANES;
#endif
  const auto vector_bytes = static_cast<std::uint32_t>(4 * made.unit_lanes);
  made.register_bytes = static_cast<std::uint32_t>(4 * lanes);
  made.uniform_bytes = vector_bytes;
  made.uniform_at = program.varying_count * made.register_bytes;
  made.bytes = made.uniform_at + std::size_t{program.uniform_count} * vector_bytes;
  const auto place = [&](const ShaderRegister& of) {
    if (!of.is_there) return 0u;
    return of.varies ? of.number * made.register_bytes : made.uniform_at + of.number * vector_bytes;
  };
  const auto next = [&](const ShaderRegister& of) {
    return static_cast<std::uint16_t>(of.is_there && of.varies ? vector_bytes : 0);
  };
  const auto vectors = static_cast<std::uint16_t>(lanes / made.unit_lanes);
  for (const ShaderStep& step : program.steps) {
    LaneStep to{.to = place(step.to),
                .a = place(step.a),
                .b = place(step.b),
                .c = place(step.c),
                .d = place(step.d),
                .a_next = next(step.a),
                .b_next = next(step.b),
                .c_next = next(step.c),
                .d_next = next(step.d),
                .vectors = step.to.is_there && !step.to.varies ? std::uint16_t{1} : vectors,
                .place = step.place,
                .count = step.count,
                .stride = step.stride,
                .op = step.op};
    if (!steers(step.op)) to.run = SOFTFOCUS_KERNEL(isa, lane_function)(step.op);
    if (step.op == static_cast<std::uint8_t>(ShaderOp::load_indexed) ||
        step.op == static_cast<std::uint8_t>(ShaderOp::store_indexed)) {
      to.stride *= made.register_bytes;
      to.vectors = vectors;
    }
    if (is_step(step.op, StepOp::jump_if_none))
      to.vectors = step.a.varies ? vectors : std::uint16_t{1};
    made.steps.push_back(to);
  }
  for (const ShaderSampleRegisters& from : program.samples) {
    const auto at = [&](const ShaderRegister& of) {
      return LaneSample::At{place(of), next(of), of.is_there};
    };
    LaneSample to{.sample = from.sample,
                  .texture = at(from.texture),
                  .sampler = at(from.sampler),
                  .compared = at(from.compared),
                  .vectors = 1};
    for (std::size_t i = 0; i < 4; ++i) to.at[i] = at(from.at[i]);
    for (std::size_t i = 0; i < 6; ++i) to.more[i] = at(from.more[i]);
    for (std::size_t i = 0; i < 3; ++i) to.offset[i] = at(from.offset[i]);
    for (std::size_t i = 0; i < 4; ++i) {
      to.to[i] = at(from.to[i]);
      if (to.to[i].next != 0) to.vectors = vectors;
    }
    made.samples.push_back(to);
  }
  made.tables = program.tables;
  return made;
}

bool run_lanes(const LaneProgram& program, LaneFrame& frame, Isa isa, std::size_t& stopped) {
  const LaneStep* const steps = program.steps.data();
  const LaneStep* step = steps;
  frame.range = {0, static_cast<std::uint32_t>(program.lanes / program.unit_lanes)};
  for (;; ++step) {
    if (step->run != nullptr) {
      step->run(*step, frame);
      continue;
    }
    switch (static_cast<StepOp>(step->op)) {
      case StepOp::jump: step = steps + step->place - 1; break;
      case StepOp::jump_if_none:
        if (!SOFTFOCUS_KERNEL(isa, any_lane)(*step, frame)) step = steps + step->place - 1;
        break;
      case StepOp::jump_if_false: {
        std::uint32_t bits = 0;
        std::memcpy(&bits, frame.memory + step->a, sizeof bits);
        if (bits == 0) step = steps + step->place - 1;
        break;
      }
      case StepOp::keep_range:
        static_assert(sizeof frame.range <= 4 * sizeof(float), "a vector has four lanes or more");
        std::memcpy(frame.memory + step->to, &frame.range, sizeof frame.range);
        break;
      case StepOp::widen_range:
        std::memcpy(&frame.range, frame.memory + step->a, sizeof frame.range);
        break;
      case StepOp::check_budget:
        if (frame.budget-- == 0) {
          stopped = static_cast<std::size_t>(step - steps);
          return false;
        }
        break;
      default: return true;
    }
  }
}

void store_lanes(Isa isa, const float* const* channels, const std::int32_t* killed, int count,
                 Format format, const Profile& profile, std::byte* to, bool are_bits) {
  if (format == Format::rgba32f && are_bits) {
    for (int i = 0; i < count; ++i) {
      if (killed != nullptr && killed[i] != 0) continue;
      for (std::size_t c = 0; c < 4; ++c) {
        std::memcpy(to + static_cast<std::size_t>(i) * 16 + 4 * c, channels[c] + i, 4);
      }
    }
    return;
  }
  if (format == Format::rgba16f && killed == nullptr) {
    SOFTFOCUS_KERNEL(isa, store_half_lanes)
    (channels, count, profile.half_store, reinterpret_cast<std::uint16_t*>(to));
    return;
  }
  const ImageView row = view_of(format, to, count, 1);
  const auto store_as = [&]<Format kFormat>(std::integral_constant<Format, kFormat>) {
    for (int i = 0; i < count; ++i) {
      if (killed != nullptr && killed[i] != 0) continue;
      store_texel<kFormat>(
          row, i, 0, {channels[0][i], channels[1][i], channels[2][i], channels[3][i]}, profile);
    }
  };
  switch (format) {
    case Format::r8: return store_as(std::integral_constant<Format, Format::r8>{});
    case Format::rgba8: return store_as(std::integral_constant<Format, Format::rgba8>{});
    case Format::srgb8: return store_as(std::integral_constant<Format, Format::srgb8>{});
    case Format::rgba16f: return store_as(std::integral_constant<Format, Format::rgba16f>{});
    case Format::r32f: return store_as(std::integral_constant<Format, Format::r32f>{});
    case Format::rgba32f: return store_as(std::integral_constant<Format, Format::rgba32f>{});
    case Format::rg16f: return store_as(std::integral_constant<Format, Format::rg16f>{});
  }
}

}  // namespace softfocus

#else  // kernels

#include "raster/images/sample_lanes.inl"
#include "raster/lanes/vector_math_lanes.inl"

#include "raster/images/sample_taps.inl"
#include "raster/images/sliced_lanes.inl"
#include "raster/shaders/math_lanes.inl"
#include "raster/shaders/operation_lanes.inl"
#include "raster/shaders/texture_lanes.inl"

namespace {

// --- steps ---

constexpr bool is_binary(ShaderOp op) {
  using enum ShaderOp;
  switch (op) {
    case negate:
    case absolute:
    case ShaderOp::floor:
    case ceiling:
    case ShaderOp::truncate:
    case round_even:
    case fraction:
    case sign:
    case ShaderOp::square_root:
    case copy: return false;
    default: return true;
  }
}
constexpr bool is_ternary(ShaderOp op) {
  using enum ShaderOp;
  return op == ShaderOp::fused_multiply_add || op == ShaderOp::select ||
         op == extract_bits_signed || op == extract_bits_unsigned || is_of_doubles(op);
}

/// Whether it is a few instructions.
constexpr bool is_short(ShaderOp op) {
  using enum ShaderOp;
  return op < fused_multiply_add || (op >= equal && op <= is_infinite) || op == ShaderOp::select ||
         op == copy || (op >= bit_and && op <= bit_not) || op == add_integers ||
         op == subtract_integers;
}

/// Calls one(), which moves on by a vector, for each of them. Most steps do so little that the
/// loop is felt: four at a time.
template <class One>
SOFTFOCUS_INLINE void for_each_vector(std::uint32_t vectors, const One& one) {
  if (vectors % 4 != 0) {
    for (; vectors > 0; --vectors) one();
    return;
  }
  for (; vectors > 0; vectors -= 4) {
    one();
    one();
    one();
    one();
  }
}

/// The vectors of an operand, from the first on. Copied from the step: what is stored could be the
/// step for all that the compiler knows.
struct Operand {
  const std::byte* at;
  std::size_t next;
  Operand(const LaneFrame& frame, std::uint32_t place, std::uint16_t bytes, LaneRange range)
      : at(frame.memory + place + (bytes != 0 ? range.first_bytes : 0)), next(bytes) {}
  SOFTFOCUS_INLINE Bits operator()() {
    const Bits v = bits_at(at);
    at += next;
    return v;
  }
  template <class Number>
  SOFTFOCUS_INLINE void copy_to(Number (&numbers)[kLanes]) {
    std::memcpy(numbers, at, sizeof numbers);
    at += next;
  }
};

SOFTFOCUS_INLINE std::byte* results_of(const LaneStep& step, const LaneFrame& frame,
                                       LaneRange range) {
  return frame.memory + step.to + range.first_bytes;
}

template <ShaderOp op>
void run_step(const LaneStep& step, LaneFrame& frame) {
  const LaneRange range = range_of(step.vectors, frame);
  Operand a{frame, step.a, step.a_next, range}, b{frame, step.b, step.b_next, range};
  Operand c{frame, step.c, step.c_next, range}, d{frame, step.d, step.d_next, range};
  std::byte* to = results_of(step, frame, range);
  const auto one = [&]() {
    Bits of_b{}, of_c{}, of_d{};
    if constexpr (is_binary(op)) of_b = b();
    if constexpr (is_ternary(op)) of_c = c();
    if constexpr (is_of_doubles(op)) of_d = d();
    put_bits(to, apply<op>(a(), of_b, of_c, of_d));
    to += sizeof(Bits);
  };
  if constexpr (is_short(op)) {
    for_each_vector(range.count, one);
  } else {
    for (std::uint32_t n = range.count; n > 0; --n) one();
  }
}

void run_and_not(const LaneStep& step, LaneFrame& frame) {
  const LaneRange range = range_of(step.vectors, frame);
  Operand a{frame, step.a, step.a_next, range}, b{frame, step.b, step.b_next, range};
  std::byte* to = results_of(step, frame, range);
  for_each_vector(range.count, [&]() {
    const Bits of_b = b();
    put_bits(to, a() & ~of_b);
    to += sizeof(Bits);
  });
}

void run_masked_copy(const LaneStep& step, LaneFrame& frame) {
  const LaneRange range = range_of(step.vectors, frame);
  Operand a{frame, step.a, step.a_next, range}, b{frame, step.b, step.b_next, range};
  std::byte* to = results_of(step, frame, range);
  for_each_vector(range.count, [&]() {
    put_bits(to, select((Mask)as_ints(b()), a(), bits_at(to)));
    to += sizeof(Bits);
  });
}

void run_multiply_add(const LaneStep& step, LaneFrame& frame) {
  const LaneRange range = range_of(step.vectors, frame);
  Operand a{frame, step.a, step.a_next, range}, b{frame, step.b, step.b_next, range};
  Operand c{frame, step.c, step.c_next, range};
  std::byte* to = results_of(step, frame, range);
  for_each_vector(range.count, [&]() {
    const Floats product = as_floats(a()) * as_floats(b());
    put_bits(to, as_bits(product + as_floats(c())));
    to += sizeof(Bits);
  });
}

// --- derivatives ---

template <ShaderOp op>
void run_derivative(const LaneStep& step, LaneFrame& frame) {
  const LaneRange range = range_of(step.vectors, frame);
  Operand a{frame, step.a, step.a_next, range};
  std::byte* to = results_of(step, frame, range);
  // softpipe has one difference for a block, along x from its second row.
  const bool is_softpipe = frame.profile->attributes == AttributeSetup::planes_by_quad;
  constexpr bool is_along_x = op == ShaderOp::derivative_x || op == ShaderOp::derivative_x_coarse;
  constexpr bool is_coarse =
      op == ShaderOp::derivative_x_coarse || op == ShaderOp::derivative_y_coarse;
  for (std::uint32_t n = range.count; n > 0; --n) {
    const Floats v = as_floats(a());
    Floats made;
    if constexpr (is_along_x) {
      made = is_softpipe ? spread<3>(v) - spread<2>(v)
             : is_coarse ? spread<1>(v) - spread<0>(v)
                         : along_x(v);
    } else {
      made = is_softpipe || is_coarse ? spread<2>(v) - spread<0>(v) : along_y(v);
      if (frame.y_is_up) made = -made;
    }
    put_bits(to, as_bits(made));
    to += sizeof(Bits);
  }
}

// --- memory by an index ---

SOFTFOCUS_INLINE std::int32_t clamped_index(std::int32_t index, std::uint32_t count) {
  return index < 0                                   ? 0
         : index >= static_cast<std::int32_t>(count) ? static_cast<std::int32_t>(count) - 1
                                                     : index;
}

// a: the index; b: the first register.
void run_load_indexed(const LaneStep& step, LaneFrame& frame) {
  const LaneRange range = range_of(step.vectors, frame);
  Operand a{frame, step.a, step.a_next, range};
  const std::byte* from = frame.memory + step.b + range.first_bytes;
  std::byte* to = results_of(step, frame, range);
  for (std::uint32_t n = range.count; n > 0; --n) {
    std::int32_t index[kLanes];
    std::uint32_t made[kLanes];
    a.copy_to(index);
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto at = static_cast<std::size_t>(clamped_index(index[lane], step.count));
      std::memcpy(&made[lane], from + at * step.stride + 4 * lane, 4);
    }
    std::memcpy(to, made, sizeof made);
    from += sizeof(Bits);
    to += sizeof(Bits);
  }
}
// a: the index; b: what is stored where c.
void run_store_indexed(const LaneStep& step, LaneFrame& frame) {
  const LaneRange range = range_of(step.vectors, frame);
  Operand a{frame, step.a, step.a_next, range}, b{frame, step.b, step.b_next, range};
  Operand c{frame, step.c, step.c_next, range};
  std::byte* to = results_of(step, frame, range);
  for (std::uint32_t n = range.count; n > 0; --n) {
    std::int32_t index[kLanes], mask[kLanes];
    std::uint32_t value[kLanes];
    a.copy_to(index);
    b.copy_to(value);
    c.copy_to(mask);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (mask[lane] == 0) continue;
      const auto at = static_cast<std::size_t>(clamped_index(index[lane], step.count));
      std::memcpy(to + at * step.stride + 4 * lane, &value[lane], 4);
    }
    to += sizeof(Bits);
  }
}
void run_load_constant(const LaneStep& step, LaneFrame& frame) {
  const LaneRange range = range_of(step.vectors, frame);
  Operand a{frame, step.a, step.a_next, range};
  std::byte* to = results_of(step, frame, range);
  const std::uint32_t* table = frame.tables.data() + step.place;
  for (std::uint32_t n = range.count; n > 0; --n) {
    std::int32_t index[kLanes];
    std::uint32_t made[kLanes];
    a.copy_to(index);
    for (int lane = 0; lane < kLanes; ++lane) {
      made[lane] =
          table[static_cast<std::size_t>(clamped_index(index[lane], step.count)) * step.stride];
    }
    std::memcpy(to, made, sizeof made);
    to += sizeof(Bits);
  }
}

// --- the table ---

template <ShaderOp op>
constexpr LaneFunction function_of() {
  using enum ShaderOp;
  if constexpr (op < derivative_x || op == copy) return run_step<op>;
  if constexpr (op >= derivative_x && op <= derivative_y_coarse) return run_derivative<op>;
  if constexpr (op == load_indexed) return run_load_indexed;
  if constexpr (op == store_indexed) return run_store_indexed;
  if constexpr (op == load_constant) return run_load_constant;
  if constexpr (op == ShaderOp::sample) return run_sample;
  return nullptr;
}

template <std::size_t... number>
constexpr std::array<LaneFunction, sizeof...(number)> all_functions(
    std::index_sequence<number...>) {
  return {function_of<static_cast<ShaderOp>(number)>()...};
}

}  // namespace

LaneFunction lane_function(std::uint8_t op) {
  constexpr auto kLast = static_cast<std::size_t>(ShaderOp::copy);
  static constexpr auto kFunctions = all_functions(std::make_index_sequence<kLast + 1>{});
  if (op <= kLast) return kFunctions[op];
  switch (static_cast<StepOp>(op)) {
    case StepOp::and_not: return run_and_not;
    case StepOp::multiply_add: return run_multiply_add;
    default: return run_masked_copy;
  }
}

bool any_lane(const LaneStep& step, LaneFrame& frame) {
  if (step.a_next == 0) return any((Mask)as_ints(bits_at(frame.memory + step.a)) != 0);
  // Of whole groups of vectors, which for_each_vector() likes.
  const std::uint32_t group = frame.range.count % 4 == 0 ? 4 : 1;
  const std::uint32_t group_bytes = group * static_cast<std::uint32_t>(sizeof(Bits));
  const auto is_set = [&](std::uint32_t first) {
    const std::byte* const at = frame.memory + step.a + first;
    Bits joined = bits_at(at);
    for (std::uint32_t i = 1; i < group; ++i) joined |= bits_at(at + i * sizeof(Bits));
    return any((Mask)as_ints(joined) != 0);
  };
  std::uint32_t first = frame.range.first_bytes, groups = frame.range.count / group;
  for (; groups > 0 && !is_set(first); --groups) first += group_bytes;
  if (groups == 0 || step.count == 0) return groups > 0;
  while (!is_set(first + (groups - 1) * group_bytes)) --groups;
  frame.range = {first, groups * group};
  return true;
}

template <HalfRounding rounding>
void store_half_lanes_rounded(const float* const* channels, int count, std::uint16_t* to) {
  for (int x = 0; x < count; x += kLanes) {
    const HalfTexels texels{float_to_half<rounding>(load(channels[0] + x)),
                            float_to_half<rounding>(load(channels[1] + x)),
                            float_to_half<rounding>(load(channels[2] + x)),
                            float_to_half<rounding>(load(channels[3] + x))};
    if (x + kLanes <= count) {
      store_half_texels(to + 4 * x, texels);
    } else {
      std::uint16_t last[4 * kLanes];
      store_half_texels(last, texels);
      std::memcpy(to + 4 * x, last, 8 * static_cast<std::size_t>(count - x));
    }
  }
}

void store_half_lanes(const float* const* channels, int count, HalfRounding rounding,
                      std::uint16_t* to) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return store_half_lanes_rounded<nearest_even>(channels, count, to);
    case toward_zero: return store_half_lanes_rounded<toward_zero>(channels, count, to);
    case swiftshader: return store_half_lanes_rounded<swiftshader>(channels, count, to);
  }
}

#endif
