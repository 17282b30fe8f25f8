#include <array>
#include <new>
#include <stdexcept>

#include "tools/cli/errors.h"
#include "tools/page/requests.h"

namespace softfocus {
namespace {

struct Request {
  std::string_view name;
  Json (*answer)(Page& page, const Json& request);
};
constexpr std::array kRequests{
    Request{"start", answer_start},
    Request{"about", answer_about},
    Request{"scenes", answer_scenes},
    Request{"open", answer_open},
    Request{"frame", answer_frame},
    Request{"pixel", answer_pixel},
    Request{"truth", answer_truth},
    Request{"compare_methods", answer_compare_methods},
    Request{"selftest", answer_selftest},
    Request{"file", answer_file},
    Request{"save", answer_save},
    Request{"shader", answer_shader},
    Request{"shader_text", answer_shader_text},
    Request{"gl_open", answer_gl_open},
    Request{"gl_frame", answer_gl_frame},
    Request{"gl_probe", answer_gl_probe},
    Request{"gl_crosscheck", answer_gl_crosscheck},
};

Json answered(Page& page, std::string_view text) {
  const std::optional<Json> request = parse_json(text);
  if (!request) throw UsageError("the request is no JSON");
  const std::string& name = request->at("do").text();
  for (const Request& known : kRequests) {
    if (known.name == name) return known.answer(page, *request);
  }
  throw UsageError("there is no request '" + name + "'; there are " + names_of(kRequests));
}

constexpr std::string_view kNoMemory = "there is not enough memory for this";

Json error_json(std::string_view message) { return {{"error", message}}; }

}  // namespace

void stop_if_cancelled(const Page& page) {
  if (page.cancel.load(std::memory_order_relaxed) != 0) throw Cancelled{};
}

std::string answer(Page& page, std::string_view request) {
  try {
    return json_text(answered(page, request));
  } catch (const Cancelled&) {
    return R"({"cancelled":true})";
  } catch (const Interrupted& interrupted) {
    return json_text({{"unfinished", interrupted.samples}});
  } catch (const std::bad_alloc&) {
    return json_text(error_json(kNoMemory));
  } catch (const std::length_error&) {  // more than 32 bits can address
    return json_text(error_json(kNoMemory));
  } catch (const std::exception& error) {
    return json_text(error_json(error.what()));
  }
}

}  // namespace softfocus
