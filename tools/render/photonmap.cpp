// ivory render --method photonmap: indirect light from a photon map, made for the picture.
#include <memory>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/cli/common.h"
#include "tools/render/method.h"
#include "tracer/render/final_gather.h"
#include "tracer/render/photons/map.h"

namespace ivory {

namespace {

struct PhotonMapOptions {
  std::uint64_t photons = PhotonMapParams{}.photons;
  int neighbours = PhotonMapParams{}.neighbours;
  std::shared_ptr<int> gather;
  std::optional<Option> gather_option;
  // What was made of them, for describe().
  std::size_t stored = 0;
  std::size_t bytes = 0;

  // Read at the visible surface unless rays are asked for.
  int gather_rays() const { return gather_option->given() ? *gather : 0; }
};

Film render(PhotonMapOptions& options, const RenderRequest& request) {
  PhotonMapParams params;
  params.photons = options.photons;
  params.neighbours = options.neighbours;
  params.seed = request.params.seed;
  params.threads = request.params.threads;
  params.target = target_in_view(request.input.lit.intersector, request.view);
  const PhotonMap map = [&] {
    Progress progress(request.common, "mapping", "photons");
    params.progress = progress.callback();
    return PhotonMap(request.input.lit, params);
  }();
  options.stored = map.photons_stored();
  options.bytes = map.bytes();
  GatherParams gather;
  gather.gather_rays = options.gather_rays();
  gather.indirect_only = request.indirect_only;
  // On the surface's geometric side: estimates stand for surfaces, not for shading normals.
  const IndirectLight light = [&map](const Surface& surface) { return map.irradiance(surface.p, surface.ng); };
  return render_gather(request.input.lit, light, request.view, request.params, gather);
}

}  // namespace

RenderMethod make_photonmap_method(Command command, const std::shared_ptr<int>& gather) {
  auto options = std::make_shared<PhotonMapOptions>();
  options->gather = gather;
  options->gather_option = command.get_option("--gather");
  command.add_count("--photons", options->photons, "Photons sent out from the lights");
  command.add_count("--neighbours", options->neighbours, 2, "Photons that an estimate of their density counts");
  RenderMethod method;
  method.name = "photonmap";
  method.summary = "photon map with precomputed irradiance, to compare with; read directly, or behind --gather rays";
  method.options = {"--photons", "--neighbours", "--gather"};
  method.noise_note = "the noise of samples, not what the photon map is off by";
  method.check = [options] {
    if (options->photons == 0) throw UsageError("--photons must be at least 1");
  };
  method.render = [options](const RenderRequest& request) { return render(*options, request); };
  method.describe = [options](Metadata& m) {
    m["photons"] = std::int64_t(options->photons);
    m["neighbours"] = std::int64_t(options->neighbours);
    m["gather_rays"] = std::int64_t(options->gather_rays());
    m["photons_stored"] = std::int64_t(options->stored);
    m["map_bytes"] = std::int64_t(options->bytes);
  };
  return method;
}

}  // namespace ivory
