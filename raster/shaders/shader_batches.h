#pragma once
// A program over one batch of lanes after the other: what pixels of a picture, vertices and
// fragments of triangles have in common.

#include <cstdint>
#include <span>
#include <vector>

#include "raster/images/decoded_texture.h"
#include "raster/images/image.h"
#include "raster/shaders/shader_lanes.h"

namespace softfocus {

struct BatchSettings {
  std::span<const ShaderTexture> textures{};  ///< by their numbers
  Profile profile{};
  std::uint64_t budget = 0;  ///< turns of loops that a batch may take
  int lanes = 0;             ///< 0: as many as are fastest
  int row_lanes = 0;         ///< of a row of pixels, past which no batch goes; 0: there are no rows
  bool y_is_up = false;      ///< dFdy is upwards
  /// All words, for a program with late ones.
  std::span<const std::uint32_t> uniforms{};
};

/// The registers of one thread, made on first use.
using BatchMemory = RowMemory<float>;

/// Refers to the program. Threads may run batches at once, each with its own memory.
class ShaderBatches {
 public:
  ShaderBatches(const ShaderProgram& program, const BatchSettings& settings, Isa isa);
  // Textures refer to what is decoded here.
  ShaderBatches(const ShaderBatches&) = delete;
  ShaderBatches& operator=(const ShaderBatches&) = delete;

  int lanes() const { return lane_program_.lanes; }
  const ShaderProgram& program() const { return program_; }

  /// The numbers of a register: lanes() of one that varies, else one.
  std::byte* place(const BatchMemory& memory, const ShaderRegister& of) const {
    return reinterpret_cast<std::byte*>(memory.get()) +
           (of.varies ? of.number * lane_program_.register_bytes
                      : lane_program_.uniform_at + of.number * lane_program_.uniform_bytes);
  }

  /// fill(input, numbers) gives lanes() numbers for each input that is no uniform. Throws
  /// ShaderError if the budget is spent.
  template <class Fill>
  void run(BatchMemory& memory, const Fill& fill) const {
    if (!memory) begin(memory);
    for (const ShaderProgram::Input& of : program_.inputs) {
      if (of.input.uniform >= 0) continue;
      fill(of.input, std::span{reinterpret_cast<std::uint32_t*>(place(memory, of.to)),
                               static_cast<std::size_t>(lanes())});
    }
    run_steps(memory);
  }

 private:
  const ShaderProgram& program_;
  Profile profile_;
  std::uint64_t budget_;
  bool y_is_up_;
  std::vector<std::uint32_t> uniforms_;
  Isa isa_;
  LaneProgram lane_program_;
  std::vector<DecodedTexture> decoded_{};
  std::vector<ShaderTexture> textures_;

  void check_shapes() const;
  void decode_textures();
  void begin(BatchMemory& memory) const;
  /// Of a register that does not vary.
  void set(const BatchMemory& memory, const ShaderRegister& of, std::uint32_t bits) const;
  void run_steps(BatchMemory& memory) const;
};

}  // namespace softfocus
