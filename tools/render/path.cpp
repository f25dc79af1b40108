// ivory render --method path.
#include <memory>

#include "tools/render/method.h"
#include "tracer/render/path_tracer.h"

namespace ivory {

RenderMethod make_path_method(Command command) {
  auto max_bounces = std::make_shared<int>(PathParams{}.max_bounces);
  command.add_count("--max-bounces", *max_bounces, 0,
                    "Surfaces that light may scatter at; Russian roulette ends most paths before");
  RenderMethod method;
  method.name = "path";
  method.summary = "reference path tracer";
  method.options = {"--max-bounces"};
  method.render = [max_bounces](const RenderRequest& request) {
    PathParams path;
    path.max_bounces = *max_bounces;
    path.indirect_only = request.indirect_only;
    return render_path(request.input.lit, request.view, request.params, path);
  };
  method.describe = [max_bounces](Metadata& m) { m["max_bounces"] = std::int64_t(*max_bounces); };
  return method;
}

}  // namespace ivory
