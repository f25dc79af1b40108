// ivory render --method path.
#include <memory>

#include <CLI/CLI.hpp>

#include "tools/render/method.h"
#include "tracer/render/path_tracer.h"

namespace ivory {

RenderMethod make_path_method(CLI::App& command) {
  auto max_bounces = std::make_shared<std::uint64_t>(PathParams{}.max_bounces);
  add_count_option(command, "--max-bounces", *max_bounces,
                   "Surfaces that light may scatter at; Russian roulette ends most paths before");
  RenderMethod method;
  method.name = "path";
  method.summary = "reference path tracer";
  method.options = {"--max-bounces"};
  method.check = [max_bounces] { int_count("--max-bounces", *max_bounces, 0); };
  method.render = [max_bounces](const RenderRequest& request) {
    PathParams path;
    path.max_bounces = int_count("--max-bounces", *max_bounces, 0);
    path.indirect_only = request.indirect_only;
    return render_path(request.input.lit, request.view, request.params, path);
  };
  method.describe = [max_bounces](Metadata& m) { m["max_bounces"] = std::int64_t(*max_bounces); };
  return method;
}

}  // namespace ivory
