#pragma once
// What is known of a shader before it runs is done before it runs. No pass changes a bit of a
// result: values that are known, are made twice, or that nothing needs.

#include <algorithm>
#include <iterator>

#include "raster/shaders/shader_ir.h"

namespace softfocus {

void simplify(ShaderTree& tree);

/// Values that are used beyond the region that makes them go by variables: other lanes may make
/// them again. A tree that is emitted needs this; simplify() does it.
void export_values(ShaderTree& tree);

/// Values that are known, or are there already, take the place of what would make them. A pass of
/// simplify().
void forward_values(ShaderTree& tree);

inline bool is_exit(const ShaderNode& node) { return node.kind == ShaderNodeKind::exit; }

/// Moves a region's nodes to the end of another.
inline void append(ShaderRegion& to, ShaderRegion&& from) {
  std::move(from.begin(), from.end(), std::back_inserter(to));
}

/// Whether a region's end cannot be reached.
bool always_leaves(const ShaderRegion& region);

/// Calls body(value) for each operand of an instruction, as a reference.
template <class Body>
void for_each_operand(ShaderTree& tree, ShaderInstruction& in, const Body& body) {
  for (ShaderValue* of : {&in.a, &in.b, &in.c, &in.d}) {
    if (*of != kNoValue) body(*of);
  }
  if (in.op != ShaderOp::sample) return;
  ShaderSample& sample = tree.samples[in.place];
  const auto each = [&](auto& list) {
    for (ShaderValue& of : list) {
      if (of != kNoValue) body(of);
    }
  };
  each(sample.at);
  each(sample.more);
  each(sample.offset);
  for (ShaderValue* of : {&sample.texture, &sample.sampler, &sample.compared}) {
    if (*of != kNoValue) body(*of);
  }
}

/// Calls body(value) for each result.
template <class Body>
void for_each_result(const ShaderTree& tree, const ShaderInstruction& in, const Body& body) {
  if (in.to != kNoValue) body(in.to);
  if (in.op != ShaderOp::sample) return;
  for (const ShaderValue of : tree.samples[in.place].to) {
    if (of != kNoValue) body(of);
  }
}

/// Calls body(variable) for each variable that a store may change.
template <class Body>
void for_each_stored(const ShaderInstruction& in, const Body& body) {
  if (in.op == ShaderOp::store) body(in.place);
  if (in.op != ShaderOp::store_indexed) return;
  for (std::uint32_t i = 0; i < in.count; ++i) body(in.place + i * in.stride);
}

/// Whether an instruction does nothing but make its value, of its operands alone.
inline bool is_pure(ShaderOp op) { return op < ShaderOp::load || op == ShaderOp::copy; }

}  // namespace softfocus
