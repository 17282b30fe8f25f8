#include "tools/bench/arithmetic.h"

#include "dof/fixed_pictures/arithmetic.h"
#include "dof/fixed_pictures/fixed_two_pass.h"
#include "scenes/draw/draw_scene.h"

namespace softfocus {

BenchRecord bench_arithmetic(const BenchOptions& options, const BenchWork& work, ThreadPool& pool,
                             const std::function<void(int run)>& on_run) {
  const auto [width, height] = work.size;
  const Image picture =
      work.scene ? draw_scene(*work.scene, work.view, work.frame, width, height, work.profile, pool)
                 : work.picture;
  const bool bytes = options.arithmetic == Arithmetic::fixed_8;
  const BytePicture byte_form = bytes ? byte_picture(picture, pool) : BytePicture{};
  const FixedTable table = fixed_table(half_table(fixed_lens(work.settings)));
  Image ours = make_image(bytes ? Format::rgba8 : Format::rgba16f, width, height);
  Image theirs = make_image(Format::rgba16f, width, height);

  const std::vector<TimedStage> fixed{{"dof", [&] {
                                         if (bytes) {
                                           fixed_two_pass(byte_form.colours, byte_form.depths,
                                                          table, ours, pool);
                                         } else {
                                           fixed_two_pass(picture, table, ours, pool);
                                         }
                                       }}};
  const std::vector<TimedStage> floats{
      {"dof", [&] {
         apply(*work.method, {picture, work.settings, work.profile}, theirs, pool);
       }}};
  warm_up(fixed);
  warm_up(floats);
  return {options, work, time_in_pairs(fixed, floats, options.runs, on_run),
          BenchPeer{"float", "the same filter in binary32", !bytes && equal(ours, theirs)}};
}

}  // namespace softfocus
