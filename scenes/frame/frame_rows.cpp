#include "scenes/frame/frame_rows.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <deque>
#include <utility>
#include <vector>

#include "dof/smooth_edges.h"
#include "dof/two_pass/two_pass_stream.h"
#include "raster/threads/loops.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/relief/impostors/scene_impostors.h"

namespace softfocus {
namespace {

/// Of a size and format, without texels.
Image without_texels(Format format, int width, int height) {
  Image image;
  image.format = format;
  image.width = width;
  image.height = height;
  return image;
}

bool is_two_pass(const Shot& shot) {
  return shot.show == Show::image && shot.method.name() == "two-pass";
}

}  // namespace

std::string why_whole(const Shot& shot, Isa isa) {
  const Scene& scene = *shot.scene;
  const bool is_sharp =
      shot.show == Show::pinhole || (shot.show == Show::image && shot.method.name() == "pinhole");
  if (!is_two_pass(shot) && !is_sharp) return "only two-pass and pinhole work by rows";
  if (shot.arithmetic != Arithmetic::floats) return "--arithmetic has no other form";
  if (shot.supersample != 1) return "--supersample halves it";
  if (!shot.effects.empty()) return "effects are of the whole picture";
  if (shot.layers.value_or(1) > 1) return "layers are drawn together";
  if (shot.lens && (shot.lens->focus_at || !shot.lens->sharp_depths.empty())) {
    return "the focus is looked for in it";
  }
  if (shot.lens && shot.lens->cuts_no_circle) return "its largest circle is looked for";
  if (has_transparent(scene)) return "the scene has transparent surfaces";
  if (has_shadows(scene)) return "the scene has shadows";
  if (has_impostors(scene)) return "objects are impostors";
  if (has_shaders(scene)) return "materials have shaders";
  if (chunks_of_scene(scene) > kPassChunks) return "the scene is drawn in several passes";
  const bool in_lanes = isa != Isa::scalar && shot.profile.coverage == Coverage::edge_functions &&
                        shot.profile.attributes != AttributeSetup::planes_by_quad;
  return in_lanes ? "" : "it is not drawn in lanes";
}

struct FrameRows::State {
  const Shot& shot;
  ThreadPool& pool;
  std::function<void(FrameStage)> on_stage;
  Frame frame{};
  PreparedScene prepared;
  Image picture, depth;  ///< of the frame's size, without texels
  TileLists tiles{};
  std::optional<TwoPassStream> stream{};
  Image drawn{};  ///< a row of tiles
  int next_tile_row = 0;
  std::deque<std::vector<std::uint16_t>> finished{};

  // If edges are smooth.
  Image other{}, coverage{};  ///< of `drawn`
  /// Rows that wait for the filter, or for the row below to be filtered; the first has been
  /// smoothed, but for the picture's.
  struct EdgeRow {
    std::vector<std::uint16_t> own, scene, other, filtered;
    std::vector<std::uint8_t> coverage;
  };
  std::deque<EdgeRow> waiting{};
  int first_waiting = 0;  ///< its row in the picture
  int filtered_rows = 0, smoothed_rows = 0;
  DofSettings edge_settings{};
  EdgeDiffusion diffusion;

  State(const Shot& of, ThreadPool& with, std::function<void(FrameStage)> told)
      : shot(of),
        pool(with),
        on_stage(std::move(told)),
        prepared(prepare_scene(*of.scene, of.profile, with)),
        picture(without_texels(Format::rgba16f, of.width, of.height)),
        depth(without_texels(Format::r32f, of.width, of.height)),
        diffusion(of.width) {
    DrawnFrame as_drawn{
        .view = camera_matrices(shot.scene->camera, shot.frame, shot.width, shot.height)};
    as_drawn.parts.opaque = without_texels(Format::rgba16f, shot.width, shot.height);
    frame.view = as_drawn.view;
    frame.method = shot.method;
    frame.sampling = shot.sampling;
    frame.samples = shot.samples;
    frame.lens = focused_lens(shot, as_drawn, pool);
    RenderPass& pass = prepared.pass;
    pass.targets.colour[0] = &picture;
    pass.targets.depth = &depth;
    if (shot.samples > 1) pass.edges = EdgeTargets{shot.samples, &other, &coverage};
    prepared.texture_reads = texture_reads_of(shot.samples);
    record_scene(prepared, frame.view, shot.frame, pass);
    sort_into_tiles({&pass, 1}, {&tiles, 1}, pool);
    if (is_two_pass(shot)) {
      edge_settings = frame.lens->settings;
      stream.emplace(shot.width, frame.lens->settings, shot.profile, pool.isa());
    }
    tell(FrameStage::done);
  }

  void tell(FrameStage stage) const {
    if (on_stage) on_stage(stage);
  }

  bool is_drawn() const { return next_tile_row * tiles.tiles_x >= tile_count(tiles); }

  /// The next row of tiles, into `drawn`.
  void draw_band() {
    const int first = next_tile_row++ * tiles.tiles_x;
    const Rectangle corner = tile_area(tiles, first);
    const int rows = corner.y_end - corner.y_begin;
    if (drawn.height != rows) drawn = make_image(Format::rgba16f, shot.width, rows);
    if (shot.samples > 1 && other.height != rows) {
      other = make_image(Format::rgba16f, shot.width, rows);
      coverage = make_image(Format::r8, shot.width, rows);
    }
    if (shot.samples > 1) prepared.pass.edges->y_begin = corner.y_begin;
    struct Scratch {
      TileMemory memory{};
      std::vector<std::byte> texels{};
    };
    for_each_with<Scratch>(pool, tiles.tiles_x, [&](int i, Scratch& scratch) {
      const Rectangle area = tile_area(tiles, first + i);
      const std::size_t row_bytes = 8 * static_cast<std::size_t>(area.x_end - area.x_begin);
      scratch.texels.resize(row_bytes * static_cast<std::size_t>(rows));
      draw_tile_aside(prepared.pass, tiles, first + i, scratch.memory, scratch.texels.data());
      for (int y = 0; y < rows; ++y) {
        std::memcpy(row<std::uint16_t>(drawn, y).data() + 4 * area.x_begin,
                    scratch.texels.data() + static_cast<std::size_t>(y) * row_bytes, row_bytes);
      }
    });
  }

  void keep_edges() {
    const auto copy = [](const auto& from) { return std::vector(from.begin(), from.end()); };
    std::vector<int> pixels;
    for (int y = 0; y < drawn.height; ++y) {
      EdgeRow& edges = waiting.emplace_back();
      edges.own = copy(row<std::uint16_t>(drawn, y));
      edges.other = copy(row<std::uint16_t>(other, y));
      edges.coverage = copy(row<std::uint8_t>(coverage, y));
      edges.scene = edges.own;
      pixels.clear();
      diffusion.next_row(edges.own, edges.other, edges.coverage, edge_settings, pixels);
      show_others(pixels, edges.other, edges.scene);
    }
  }

  EdgeRow& edge_row(int y) { return waiting[static_cast<std::size_t>(y - first_waiting)]; }

  /// Takes the next row of the filtered picture. A row is smoothed once the one below it is there.
  void keep(std::span<const std::uint16_t> of) {
    if (shot.samples == 1) {
      finished.emplace_back(of.begin(), of.end());
      return;
    }
    edge_row(filtered_rows++).filtered.assign(of.begin(), of.end());
    if (filtered_rows > 1) smooth_next();
    if (filtered_rows == shot.height) smooth_next();
  }

  void smooth_next() {
    const int y = smoothed_rows++;
    EdgeRows rows;
    for (int i = 0; i < 3; ++i) {
      const EdgeRow& of = edge_row(std::clamp(y + i - 1, 0, shot.height - 1));
      rows.scene[static_cast<std::size_t>(i)] = of.scene;
      rows.filtered[static_cast<std::size_t>(i)] = of.filtered;
    }
    const EdgeRow& own = edge_row(y);
    rows.own = own.own;
    rows.other = own.other;
    rows.coverage = own.coverage;
    std::vector<SmoothPixel> changed;
    smooth_row(rows, edge_settings, shot.profile.half_store, changed);
    std::vector<std::uint16_t>& to = finished.emplace_back(own.filtered);
    for (const SmoothPixel& pixel : changed) {
      std::copy(pixel.texel.begin(), pixel.texel.end(), to.begin() + std::ptrdiff_t{4} * pixel.x);
    }
    if (y == 0) return;
    waiting.pop_front();
    ++first_waiting;
  }

  /// Draws a band, or ends the picture.
  void go_on(const FrameBandSink& on_drawn) {
    const RowSink sink = [&](std::span<const std::uint16_t> of) { keep(of); };
    if (is_drawn()) {
      assert(stream);
      tell(FrameStage::filtering);
      return end_rows(*stream, pool, sink);
    }
    tell(FrameStage::drawing);
    draw_band();
    const int first = first_waiting + static_cast<int>(waiting.size());
    if (shot.samples > 1) keep_edges();
    if (on_drawn) on_drawn(drawn);
    if (stream) tell(FrameStage::filtering);
    for (int y = 0; y < drawn.height; ++y) {
      const std::span<const std::uint16_t> next =
          shot.samples > 1 ? std::span<const std::uint16_t>{edge_row(first + y).scene}
                           : row<std::uint16_t>(std::as_const(drawn), y);
      stream ? put_row(*stream, next, pool, sink) : keep(next);
    }
  }
};

FrameRows::FrameRows(const Shot& shot, ThreadPool& pool,
                     const std::function<void(FrameStage)>& on_stage) {
  if (on_stage) on_stage(FrameStage::drawing);
  state_ = std::make_unique<State>(shot, pool, on_stage);
}
FrameRows::~FrameRows() = default;

const Frame& FrameRows::frame() const { return state_->frame; }

void FrameRows::make(int count, Image& to, const FrameBandSink& on_drawn) {
  State& state = *state_;
  if (to.width != state.shot.width || to.height != count) {
    to = make_image(Format::rgba16f, state.shot.width, count);
  }
  while (state.finished.size() < static_cast<std::size_t>(count)) state.go_on(on_drawn);
  state.tell(FrameStage::done);
  for (int y = 0; y < count; ++y) {
    std::copy(state.finished.front().begin(), state.finished.front().end(),
              row<std::uint16_t>(to, y).begin());
    state.finished.pop_front();
  }
}

}  // namespace softfocus
