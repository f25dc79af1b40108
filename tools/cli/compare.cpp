// ivory compare: how far a picture is from a reference.
#include "tracer/image/compare.h"

#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tracer/image/file.h"

namespace ivory {

namespace {

struct CompareOptions {
  std::string image;
  std::string reference;
  std::string second;
};

Film read_noting(const std::string& path, std::vector<std::string>& warnings) {
  ImageFile file = read_image_file(path);
  warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
  return std::move(file.film);
}

Film read_reference(const std::string& path, const std::string& image_path, const Film& image,
                    std::vector<std::string>& warnings) {
  Film reference = read_noting(path, warnings);
  if (image.width != reference.width || image.height != reference.height) {
    throw Error(image_path,
                fmt::format("is {} x {}, the reference {} is {} x {}", image.width, image.height, path, reference.width,
                            reference.height),
                "render both with the same --size");
  }
  return reference;
}

void run_compare(const CompareOptions& options, const CommonOptions& common) {
  std::vector<std::string> warnings;
  const Film image = read_noting(options.image, warnings);
  const Film reference = read_reference(options.reference, options.image, image, warnings);
  const bool two = !options.second.empty();
  const ImageDifference d =
      two ? compare_images(image, reference, read_reference(options.second, options.image, image, warnings))
          : compare_images(image, reference);
  print_warnings(common, warnings);
  // JSON has no infinity: a flat reference gives null.
  nlohmann::ordered_json result;
  result["image"] = options.image;
  result["reference"] = options.reference;
  if (two) result["second_reference"] = options.second;
  result["nrmse"] = d.nrmse;
  result["relative_rmse"] = d.relative_rmse;
  result["rmse"] = d.rmse;
  result["max"] = d.max;
  result["bias"] = d.bias;
  result["reference_mean"] = d.reference_mean;
  result["warnings"] = warnings;
  result["nrmse_standard_error"] = d.nrmse_standard_error;
  result["relative_rmse_standard_error"] = d.relative_rmse_standard_error;
  std::string text = fmt::format(
      "nrmse {:.6g}\nrelative_rmse {:.6g}\nrmse {:.6g}\nmax {:.6g}\nbias {:.6g}\nnrmse_standard_error {:.6g}\n"
      "relative_rmse_standard_error {:.6g}\n",
      d.nrmse, d.relative_rmse, d.rmse, d.max, d.bias, d.nrmse_standard_error, d.relative_rmse_standard_error);
  if (two) {
    result["reference_nrmse"] = d.reference_nrmse;
    result["reference_relative_rmse"] = d.reference_relative_rmse;
    text += fmt::format("reference_nrmse {:.6g}\nreference_relative_rmse {:.6g}\n", d.reference_nrmse,
                        d.reference_relative_rmse);
  }
  print_result(common, result, text);
}

}  // namespace

void add_compare_command(Command app, CommonOptions& common) {
  Command command = app.add_subcommand("compare", "Measure how far a picture is from a reference");
  auto options = std::make_shared<CompareOptions>();
  command.add_option("image", options->image, "Picture to judge").required().type_name("A");
  command.add_option("reference", options->reference, "Picture taken as truth, of the same size")
      .required()
      .type_name("REF");
  command
      .add_option(
          "second", options->second,
          "The same picture with noise of its own, as by another --seed: the references' noise is then left out")
      .type_name("REF2");
  command.footer(
      "Over all pixels and the channels red, green and blue, a in A and b in REF:\n"
      "  nrmse          root of mean (a-b)^2, divided by max b - min b\n"
      "  relative_rmse  root of mean (a-b)^2 / (b^2 + (0.01 mean b)^2)\n"
      "  max, bias      largest |a-b|, mean a-b\n"
      "  nrmse_standard_error, relative_rmse_standard_error\n"
      "                 from blocks of 8x8 pixels\n"
      "With c in REF2, (a-b)(a-c) takes the place of (a-b)^2, so that the noise of REF and REF2 is left out; (b+c)/2\n"
      "takes that of b, and in the divisor of relative_rmse its mean over the 5x5 around the pixel, the pixel left "
      "out.\n"
      "Where the mean of (a-b)(a-c) is below zero, nrmse is 0: A is then at most about nrmse_standard_error off.\n"
      "  reference_nrmse, reference_relative_rmse\n"
      "                 the noise of (b+c)/2, which a perfect A compared with (b+c)/2 would show; it has been taken\n"
      "                 out of nrmse and relative_rmse, and is no lower limit of theirs\n"
      "\nExample:\n"
      "  ivory compare gather.exr path.exr --json");
  set_action(command, common, Output::none, [options, &common] { run_compare(*options, common); });
}

}  // namespace ivory
