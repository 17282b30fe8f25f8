#include "tools/info/words.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "tools/cli/command_description.h"

namespace softfocus {
namespace {

constexpr std::array kWords{
    Word{"accumulation buffer, accumulation",
         "The mean of pictures from many points of the lens: right, and slow.",
         "softfocus render --method accumulation, docs/ground-truth.md"},
    Word{"alpha to coverage", "A surface's opacity decides how many samples of a pixel it has.",
         "softfocus render --multisample, docs/specification.md"},
    Word{
        "anti-aliasing, MSAA, multisampling, jaggies, stairs",
        "Several samples a pixel, so that edges are smooth; each side is blurred at its own depth.",
        "softfocus render --multisample, softfocus apply --effect temporal-aa, "
        "softfocus chart --of anti-aliasing, docs/methods.md"},
    Word{"aperture, f-number, f-stop, N",
         "The opening of the lens. The f-number is focal length over its diameter: smaller numbers "
         "blur more.",
         "softfocus render --f-number, softfocus lens, docs/lens.md"},
    Word{"aperture blades, polygonal bokeh, hexagonal bokeh",
         "Blades make the opening, and so the circles, polygons.",
         "softfocus render --aperture-blades, softfocus render --method hexagonal, "
         "docs/methods.md"},
    Word{"autofocus, focus at", "The focus is the depth that a pixel shows.",
         "softfocus render --autofocus, softfocus refocus --focus-at, docs/command-line.md"},
    Word{"billboard, imposter, impostor, sprite",
         "A picture of an object in its place. With a depth in each texel it can be seen from the "
         "side.",
         "softfocus relief, docs/impostors.md"},
    Word{"bit exact, reproducible, deterministic",
         "The same bits on every machine, compiler and number of threads.",
         "softfocus selftest, softfocus crosscheck, docs/exactness.md, docs/portability.md"},
    Word{"bloom, glow, bright pass", "Light above a threshold, scattered over its surroundings.",
         "softfocus apply --effect bloom, docs/effects/bloom.md"},
    Word{"bokeh", "How blurred lights look: the shape and evenness of their circles.",
         "softfocus render --method disc-layers, softfocus render --aperture-blades, "
         "docs/failures.md"},
    Word{"cat's eye, vignetting, anamorphic, swirl",
         "Away from the middle the lens's rim cuts circles; anamorphic lenses stretch them.",
         "softfocus render --method scatter-aperture, docs/methods.md"},
    Word{
        "circle of confusion, CoC, blur circle",
        "The disc that a point out of focus makes. Radii are in pixels, negative before the focus.",
        "softfocus lens, softfocus render --show coc, docs/lens.md"},
    Word{"compute shader, CUDA, OpenCL",
         "Left out: a full-screen pass in tiles on a CPU does the same work, and equals a driver's "
         "fragment shader.",
         "softfocus apply --shader, docs/shaders.md"},
    Word{"deferred shading, visibility buffer",
         "A tile finds each pixel's triangle first, then shades it once.", "docs/code-guide.md"},
    Word{"depth map, depth buffer, z-buffer, z-pass, disparity",
         "A depth for each pixel, in one of a dozen encodings.",
         "softfocus refocus --depth-encoding, softfocus inspect, docs/refocus.md"},
    Word{"depth of field, DoF", "The range of depths whose circles are too small to see.",
         "softfocus lens, softfocus render --method, docs/depth-of-field.md, docs/methods.md"},
    Word{"depth peeling, layered depth image",
         "The second surface of each pixel, the third, and so on.",
         "softfocus render --layers, softfocus render --method layered, docs/methods.md"},
    Word{"edge detection, Laplacian", "A pixel eight times, less its eight neighbours.",
         "softfocus apply --effect edge-detection, docs/effects/kernels.md"},
    Word{"fixed point, integer arithmetic, microcontroller, Cortex-M",
         "two-pass in integers, in strips of kilobytes.",
         "softfocus refocus --arithmetic, docs/fixed-point.md, docs/embedded.md"},
    Word{"FLIP, SSIM, PSNR, image difference",
         "Numbers for how different two pictures are; FLIP's is what an eye would see.",
         "softfocus compare, docs/measures.md"},
    Word{"focal length, field of view",
         "A longer lens blurs more, by its square over the f-number; a scene's view stays.",
         "softfocus render --focal-length, softfocus lens, docs/lens.md"},
    Word{"gather, scatter",
         "A gather asks for each pixel what reaches it, a scatter sends each pixel's light to its "
         "circle.",
         "softfocus render --method one-pass, softfocus render --method scatter, "
         "docs/methods.md"},
    Word{"Gaussian, box filter, dual filter, Kawase, convolution, kernel, downsampling, sharpen",
         "Blurs of one width everywhere, and other weighted means of neighbours.",
         "softfocus apply --effect gaussian, softfocus apply --effect dual-filter, "
         "docs/effects/kernels.md"},
    Word{"ghosting, discs, views show", "Too few views of the lens stand side by side.",
         "softfocus render --samples, softfocus render --method filtered-views, "
         "docs/ground-truth.md"},
    Word{"GLSL, HLSL, Shadertoy, SPIR-V, custom shader, user shader",
         "A shader of your own runs here with the same bits everywhere.",
         "softfocus apply --shader, softfocus shaders, docs/shaders.md"},
    Word{"glTF, glb, OBJ, PLY, STL, model, three.js, Blender",
         "A model is a scene, or a part of one.", "softfocus render, docs/scene-format.md"},
    Word{"golden image, regression test, visual test, snapshot, pytest",
         "A picture that a test expects, told by its hash or a tolerance.",
         "softfocus golden, softfocus compare, docs/goldens.md"},
    Word{"ground truth, reference image", "What a lens would show, with its noise.",
         "softfocus render --method accumulation, softfocus render --method ray-traced, "
         "docs/ground-truth.md"},
    Word{"guard band, clipping", "Room around the picture in which triangles need not be clipped.",
         "docs/specification.md, docs/code-guide.md"},
    Word{"half float, binary16, RGBA16F, FP16",
         "Numbers of 16 bits with 11 significant ones, in which pictures and depths are kept.",
         "softfocus render --profile, docs/specification.md, docs/exactness.md"},
    Word{"heat diffusion, diffusion depth of field",
         "Colour spreads like heat, the more the larger the circle.",
         "softfocus render --method diffusion, docs/methods.md"},
    Word{"hidden background, occlusion, disocclusion, inpainting, hole filling",
         "What near things hide is guessed, or drawn where the scene is there.",
         "softfocus render --method layered, softfocus refocus --holes, docs/methods.md, "
         "docs/failures.md"},
    Word{"highlight, specular highlight, light",
         "Lights far brighter than what is around them become discs of the circle's size.",
         "softfocus render --method disc-layers, docs/failures.md"},
    Word{"hyperfocal distance", "The nearest focus at which infinity still looks sharp.",
         "softfocus lens, docs/lens.md"},
    Word{"intensity leakage, colour bleeding, halo, light leak",
         "A sharp thing's colour in the blur beside it, or a blurred thing's on a sharp one.",
         "softfocus render --leak, softfocus stress --cases leak-far, docs/depth-of-field.md, "
         "docs/failures.md"},
    Word{"lens flare, god rays, light shafts, radial blur, ghost",
         "Reflections and rays of bright light.",
         "softfocus apply --effect lens-flare, docs/effects/lens-flare.md"},
    Word{"light field, lens view, multi view",
         "Pictures from several points of the lens, drawn or warped.",
         "softfocus render --method filtered-views, softfocus render --method warped-accumulation, "
         "docs/methods.md"},
    Word{"llvmpipe, SwiftShader, softpipe, driver, profile",
         "Named drivers whose bits can be had here without them.",
         "softfocus profiles, softfocus render --profile, softfocus probe, docs/exactness.md"},
    Word{"mipmap, level of detail, trilinear, anisotropic filtering",
         "Smaller copies of a texture, or of the picture, for what is far or blurred.",
         "softfocus render --method mipmap, docs/specification.md"},
    Word{"motion blur, shutter, velocity buffer, motion vector",
         "What moves while the shutter is open, from each pixel's velocity, or from many times.",
         "softfocus apply --effect motion-blur, softfocus render --shutter, "
         "docs/effects/motion-blur.md"},
    Word{"near field, far field, focus field, 2.5D",
         "What lies before the focus, behind it, and in it, as pictures of their own.",
         "softfocus render --method layers, softfocus render --method fields, docs/methods.md"},
    Word{"normal map, bump map, height field", "Directions or heights in a texture's texels.",
         "softfocus relief make, docs/relief.md"},
    Word{"object, object identification, segmentation", "Which object each pixel shows.",
         "softfocus render --method object-identification, docs/methods.md"},
    Word{"out of memory, memory, large picture, tiles",
         "Pictures are made by rows, or by several machines.",
         "softfocus render --shard, docs/performance.md, docs/farm.md"},
    Word{"page, simulator, web, browser, WebAssembly, slider",
         "The program in a web page, with sliders for all that a lens has.",
         "docs/simulator.md, docs/teaching.md"},
    Word{"partial occlusion, semi-transparent outline, see past",
         "A lens sees past a near thing that is narrower than its circle.",
         "softfocus stress --cases partial-occlusion, docs/failures.md"},
    Word{"pinhole, no lens, sharp", "Everything in focus.",
         "softfocus render --show pinhole, docs/depth-of-field.md"},
    Word{"photograph, Lightroom, portrait mode, bokeh from depth",
         "A picture and its depth get the depth of field of a lens.",
         "softfocus refocus, docs/refocus.md"},
    Word{"post-process, full-screen pass, full-screen triangle, render target, ping-pong",
         "A shader over the whole picture, from one texture to another.",
         "softfocus shaders, softfocus apply --pipeline, docs/shaders.md, docs/depth-of-field.md"},
    Word{"premultiplied alpha, transparency, glass, order-independent",
         "Layers of glass are filtered by themselves and laid over each other.",
         "softfocus render --method disc-layers, docs/methods.md, docs/scene-format.md"},
    Word{"Python, NumPy, wheel, C API, library, embed, ctypes",
         "The filters over a program's own memory.", "docs/embedding.md"},
    Word{"rack focus, focus pull, keyframes", "The focus moves from frame to frame.",
         "softfocus render --keyframes, docs/command-line.md"},
    Word{"rasterization, rasterizer, software GPU, software renderer",
         "Triangles become pixels, by the rules that GPUs have.",
         "softfocus render, softfocus bench, docs/specification.md, docs/code-guide.md"},
    Word{"radiosity, global illumination",
         "Left out: light comes from lights and an ambient share alone.", "docs/scene-format.md"},
    Word{"ray tracing, Embree, distribution ray tracing", "Rays through points of the lens.",
         "softfocus render --method ray-traced, docs/ground-truth.md"},
    Word{"relief mapping, parallax, texture warping",
         "A texture with depth, warped to what another eye sees.",
         "softfocus relief turn, docs/relief.md, docs/impostors.md"},
    Word{"rim, edge-spread, point spread, PSF", "How light spreads from a point or an edge.",
         "softfocus stress --cases point-radius, docs/failures.md"},
    Word{"sensor, film, full frame, crop, 35 mm",
         "The size on which the lens draws: with the focal length it gives the view.",
         "softfocus refocus --sensor, softfocus lens, docs/lens.md"},
    Word{"separable filter, two passes", "A horizontal pass, then a vertical one.",
         "softfocus render --method two-pass, docs/methods.md"},
    Word{"shadow, shadow map, shadow volume, projected shadow, planar shadow, soft shadow, "
         "stencil, umbra, "
         "penumbra, shadow acne, percentage closer filtering, cascades, terminator",
         "Where a light is hidden: projected and cut exactly, or by volumes, maps and rays.",
         "softfocus render --shadows, softfocus shadows, docs/shadows.md"},
    Word{"tilt-shift, miniature", "Left out: the plane of focus is square to the axis.",
         "docs/lens.md"},
    Word{"tone mapping, HDR, exposure, ACES",
         "A curve from light of any strength to what a screen shows.",
         "softfocus render --tone-map, docs/effects/tone-mapping.md"},
    Word{"temporal anti-aliasing, TAA, reprojection, running average",
         "What frames before have shown, moved to where it is now.",
         "softfocus render --effect temporal-aa, softfocus render --effect reproject, "
         "docs/effects/temporal-anti-aliasing.md, docs/effects/reprojection.md"},
    Word{"texture, sampler, bilinear filtering, look-up table, LUT",
         "Bilinear samples with the bits of each profile; slices of a strip are a 3D texture.",
         "softfocus apply --texture, docs/specification.md, docs/shaders.md"},
    Word{"ULP, rounding, floating point, fused multiply-add, FMA",
         "The order and rounding of each operation is written down.",
         "softfocus crosscheck, docs/exactness.md, docs/specification.md"},
    Word{"auto, which method, best method, quality against speed",
         "Error against ground truth, and time, of every method.",
         "softfocus chart, softfocus render --method auto, docs/methods.md, docs/chart.md"},
};

/// In small letters, a blank for each hyphen, words of more than three letters without an s at the
/// end.
std::string simple(std::string_view name) {
  std::string result;
  std::size_t begin = 0;
  const auto end_word = [&] {
    if (result.size() - begin > 3 && result.back() == 's') result.pop_back();
  };
  for (const char c : name) {
    if (c == ' ' || c == '-' || c == '_') {
      end_word();
      result += ' ';
      begin = result.size();
    } else {
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  end_word();
  return result;
}

/// Calls `visit` with each part between ", ".
template <class Visit>
void for_each_part(std::string_view list, const Visit& visit) {
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(", ", begin), list.size());
    visit(list.substr(begin, end - begin));
    begin = end + 2;
  }
}

}  // namespace

std::span<const Word> words() { return kWords; }

std::vector<Word> find_words(std::string_view name) {
  const std::string wanted = simple(name);
  std::vector<Word> same, partly;
  for (const Word& word : kWords) {
    bool is_same = false, has_part = false;
    for_each_part(word.names, [&](std::string_view one) {
      const std::string known = simple(one);
      is_same = is_same || known == wanted;
      has_part = has_part || (" " + known).find(" " + wanted) != std::string::npos;
    });
    if (is_same) same.push_back(word);
    if (has_part) partly.push_back(word);
  }
  return same.empty() ? partly : same;
}

std::string text_of(const Word& word, int columns) {
  const std::size_t width = text_width(columns);
  std::string text;
  append_wrapped(text, 0, word.names, 0, width);
  text += "  ";
  append_wrapped(text, 2, word.meaning, 2, width);
  for_each_part(word.places,
                [&](std::string_view place) { text += "    " + std::string{place} + '\n'; });
  return text;
}

}  // namespace softfocus
