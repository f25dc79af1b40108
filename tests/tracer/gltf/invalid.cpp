// The files of the Khronos glTF validator's own tests: each ends in one clear line, or in a scene
// that holds together.
#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/scene_check.h"
#include "tracer/gltf/loader.h"

namespace ivory {
namespace {

struct Row {
  std::string uri;
  int errors = 0;
  std::vector<std::string> codes;
};

std::vector<Row> read_rows(const std::string& path) {
  std::vector<Row> rows;
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    Row row;
    std::string errors, warnings, codes;
    std::getline(fields, row.uri, '\t');
    std::getline(fields, errors, '\t');
    std::getline(fields, warnings, '\t');
    std::getline(fields, codes, '\t');
    row.errors = std::stoi(errors);
    std::istringstream list(codes);
    for (std::string code; std::getline(list, code, ',');) row.codes.push_back(code);
    rows.push_back(row);
  }
  return rows;
}

// Faults that do not touch what ivory computes, so that the scene is right all the same.
const std::set<std::string> harmless_codes{
    // bounds and targets that only promise something about data that is read as it is
    "ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND", "ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND", "ACCESSOR_MAX_MISMATCH",
    "ACCESSOR_MIN_MISMATCH", "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS", "BUFFER_VIEW_TARGET_OVERRIDE",
    "BUFFER_VIEW_INVALID_BYTE_STRIDE",
    // alignment: elements are copied byte by byte
    "ACCESSOR_OFFSET_ALIGNMENT", "ACCESSOR_TOTAL_OFFSET_ALIGNMENT", "ACCESSOR_MATRIX_ALIGNMENT",
    "MESH_PRIMITIVE_ACCESSOR_UNALIGNED", "MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE",
    "MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE", "IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE",
    // an empty list, or a list with a double, means what it says
    "EMPTY_ENTITY", "DUPLICATE_ELEMENTS", "UNEXPECTED_EXTENSION_OBJECT", "UNDECLARED_EXTENSION",
    "NON_REQUIRED_EXTENSION",
    // mended with a warning: colours clamped, normals normalised, textures without coordinates left out
    "ACCESSOR_NON_CLAMPED", "ACCESSOR_VECTOR3_NON_UNIT", "ACCESSOR_INVALID_SIGN", "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS",
    "MESH_PRIMITIVE_NO_TANGENT_SPACE",
    // attributes and morph targets that are not read
    "MESH_PRIMITIVE_INVALID_ATTRIBUTE", "MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY",
    "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT", "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR",
    "MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT", "MESH_INVALID_WEIGHTS_COUNT", "NODE_WEIGHTS_INVALID",
    // joints of meshes that no skin poses, and of points; a skin on a mesh without joints leaves it rigid, with a
    // warning
    "MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH", "ACCESSOR_JOINTS_INDEX_DUPLICATE", "ACCESSOR_JOINTS_INDEX_OOB",
    "ACCESSOR_WEIGHTS_NEGATIVE", "ACCESSOR_WEIGHTS_NON_NORMALIZED", "NODE_SKIN_WITH_NON_SKINNED_MESH",
    // joints may hang anywhere
    "SKIN_NO_COMMON_ROOT", "NODE_SKIN_NO_SCENE", "SKIN_SKELETON_INVALID", "SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE",
    // mended with a warning
    "KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES",
    // names of media types and marks in front of the text
    "BUFFER_DATA_URI_MIME_TYPE_INVALID", "IMAGE_MIME_TYPE_INVALID", "TEXTURE_INVALID_IMAGE_MIME_TYPE",
    "IMAGE_NON_ENABLED_MIME_TYPE"};

// Files whose faulty part nothing in the scene uses, or whose fault is of a harmless kind among
// graver ones of the same name.
const std::set<std::string> tolerated_files{
    "test/base/data/accessor/byteoffset_no_bufferview.gltf",     // offset 0
    "test/base/data/accessor_data/invalid_elements_float.gltf",  // accessor of no mesh
    "test/base/data/buffer/invalid_uri_data.gltf",               // ";;base64"
    "test/base/data/buffer_view/invalid_stride_too_big.gltf",    // view without accessor
    "test/base/data/camera/extra_type.gltf",                     // type says which one counts
    "test/base/data/glb/bom.glb",
    "test/base/data/json/bom.gltf",                // byte order mark
    "test/base/data/image/invalid_data_uri.gltf",  // images that no material shows
    "test/base/data/image/invalid_data_uri_mime_type.gltf",
    "test/base/data/image/invalid_image_data.gltf",
    "test/base/data/image/invalid_uri_scheme.gltf",
    "test/base/data/image/missing_mime_type_buffer_view.gltf",
    "test/base/data/image/not_found.gltf",
    "test/base/data/image/png_eos.gltf",
    "test/base/data/node/skin_with_no_mesh.gltf",
    "test/base/data/node/weights_with_no_mesh.gltf",
    "test/base/data/skin/ibm_invalid_count.gltf",  // skins of no mesh
    "test/base/data/skin/ibm_invalid_format.gltf",
    "test/base/data/skin/unresolved_skeleton.gltf",  // which is not read
    "test/base/data/skin_data/invalid_ibm.gltf",
    "test/base/data/root/extensions_non_objects.gltf",                    // of unknown extensions
    "test/ext/KHR_materials_anisotropy/data/material/out_of_range.gltf",  // extensions that are ignored
    "test/ext/KHR_materials_dispersion/data/material/out_of_range.gltf",
    "test/ext/KHR_materials_volume/data/material/out_of_range.gltf"};

bool tolerated(const Row& row) {
  // Animations are read at a time only: the next test.
  for (const char* unread : {"/animation/", "/animation_data/", "KHR_materials_variants"})
    if (row.uri.find(unread) != std::string::npos) return true;
  if (tolerated_files.contains(row.uri)) return true;
  return std::all_of(row.codes.begin(), row.codes.end(),
                     [](const std::string& c) { return harmless_codes.contains(c); });
}

// Files without errors in the validator's sense that ivory cannot use, and why.
const std::map<std::string, std::string> refused_valid_files{
    {"test/base/data/accessor/unknown_type.gltf", "accessors[0].type"},
    {"test/base/data/asset/min_version_valid.gltf", "glTF 2.1"},
    {"test/base/data/buffer/non_relative_uri.gltf", "http://"},
    {"test/base/data/camera/perspective_yfov.gltf", "yfov is 4"},
    {"test/base/data/root/named_objects.gltf", "no data"},
    {"test/base/data/root/unused_objects.gltf", "no data"}};

TEST(GltfInvalid, EveryFileOfTheValidatorEndsInOneLineOrAConsistentScene) {
  const std::string folder = sample_data();
  if (folder.empty() || !std::filesystem::exists(folder + "/invalid/EXPECTED.tsv")) GTEST_SKIP() << no_sample_data;
  const std::vector<Row> rows = read_rows(folder + "/invalid/EXPECTED.tsv");
  ASSERT_EQ(rows.size(), 372U);
  int thrown = 0;
  for (const Row& row : rows) {
    const std::string path = folder + "/invalid/" + row.uri;
    SCOPED_TRACE(row.uri);
    std::string error;
    try {
      const LoadedScene loaded = load_gltf(path);
      EXPECT_EQ(find_fault(loaded.scene), "");
      for (const std::string& warning : loaded.warnings) {
        EXPECT_EQ(warning.find('\n'), std::string::npos) << warning;
        EXPECT_TRUE(warning.starts_with(path)) << warning;
      }
    } catch (const Error& e) {
      error = e.what();
      ++thrown;
      EXPECT_TRUE(error.starts_with(path + ": ")) << error;
      EXPECT_NE(error.find("; "), std::string::npos) << "no remedy: " << error;
      EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    }
    if (row.errors == 0) {
      const auto refused = refused_valid_files.find(row.uri);
      if (refused == refused_valid_files.end())
        EXPECT_EQ(error, "");
      else
        EXPECT_NE(error.find(refused->second), std::string::npos) << error;
    } else if (!tolerated(row)) {
      EXPECT_NE(error, "") << "loaded in spite of " << row.codes.front();
    }
  }
  // A change of this number is a change of what ivory accepts.
  EXPECT_EQ(thrown, 123);
}

// The same of animations, whose files hold nothing else.
TEST(GltfInvalid, AnimationsAreJudgedWhereATimeIsAskedFor) {
  const std::string folder = sample_data();
  if (folder.empty() || !std::filesystem::exists(folder + "/invalid/EXPECTED.tsv")) GTEST_SKIP() << no_sample_data;
  int refused = 0;
  for (const Row& row : read_rows(folder + "/invalid/EXPECTED.tsv")) {
    if (!row.uri.starts_with("test/base/data/animation")) continue;
    SCOPED_TRACE(row.uri);
    std::string error;
    try {
      LoadParams params;
      params.time_s = 0.5;
      EXPECT_EQ(find_fault(load_gltf(folder + "/invalid/" + row.uri, params).scene), "");
    } catch (const Error& e) {
      error = e.what();
      ++refused;
    } catch (const ParameterError& e) {
      error = e.what();  // an empty list of animations
      EXPECT_NE(error.find("no animation"), std::string::npos) << error;
    }
    // Its times have no data, so that all are 0.
    const bool timeless = row.uri == "test/base/data/animation/valid.gltf";
    const bool harmless = row.codes == std::vector<std::string>{"ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS"};
    const bool good = (row.errors == 0 || harmless) && !timeless;
    EXPECT_EQ(error.empty(), good) << error;
  }
  EXPECT_EQ(refused, 17);
}

}  // namespace
}  // namespace ivory
