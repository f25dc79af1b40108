// ivory compare: how far a picture is from a reference.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/error.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tracer/image_compare.h"
#include "tracer/image_io.h"

namespace ivory {

namespace {

struct CompareOptions {
  std::string image;
  std::string reference;
};

void run_compare(const CompareOptions& options, const CommonOptions& common) {
  const Film image = read_image(options.image);
  const Film reference = read_image(options.reference);
  if (image.width != reference.width || image.height != reference.height) {
    throw Error(options.image,
                fmt::format("is {} x {}, the reference {} is {} x {}", image.width, image.height, options.reference,
                            reference.width, reference.height),
                "render both with the same --size");
  }
  const ImageDifference d = compare_images(image, reference);
  // JSON has no infinity: a flat reference gives null.
  nlohmann::ordered_json result;
  result["image"] = options.image;
  result["reference"] = options.reference;
  result["nrmse"] = d.nrmse;
  result["relative_rmse"] = d.relative_rmse;
  result["rmse"] = d.rmse;
  result["max"] = d.max;
  result["bias"] = d.bias;
  result["reference_mean"] = d.reference_mean;
  print_result(common, result,
               fmt::format("nrmse {:.6g}\nrelative_rmse {:.6g}\nrmse {:.6g}\nmax {:.6g}\nbias {:.6g}\n", d.nrmse,
                           d.relative_rmse, d.rmse, d.max, d.bias));
}

}  // namespace

void add_compare_command(CLI::App& app, CommonOptions& common) {
  auto* command = app.add_subcommand("compare", "Measure how far a picture is from a reference");
  auto options = std::make_shared<CompareOptions>();
  command->add_option("image", options->image, "Picture to judge")->required()->type_name("A");
  command->add_option("reference", options->reference, "Picture taken as truth, of the same size")
      ->required()
      ->type_name("REF");
  command->footer(
      "Over all pixels and the channels red, green and blue, a in A and b in REF:\n"
      "  nrmse          root of mean (a-b)^2, divided by max b - min b\n"
      "  relative_rmse  root of mean (a-b)^2 / (b^2 + (0.01 mean b)^2)\n"
      "  max, bias      largest |a-b|, mean a-b\n"
      "Example:\n"
      "  ivory compare gather.exr path.exr --json");
  set_action(*command, common, Output::none, [options, &common] { run_compare(*options, common); });
}

}  // namespace ivory
