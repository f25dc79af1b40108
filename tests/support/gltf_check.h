// Loading glTF files that must come out sound.
#pragma once

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/scene_check.h"
#include "tracer/gltf/loader.h"

namespace ivory {

inline LoadedScene load(const std::string& path, const LoadParams& params = {}) {
  LoadedScene loaded = load_gltf(path, params);
  EXPECT_EQ(find_fault(loaded.scene), "");
  return loaded;
}

inline LoadedScene load(const GltfBuilder& builder, const std::string& name) { return load(builder.write(name)); }

inline std::string error_of(const GltfBuilder& builder, const std::string& name, const LoadParams& params = {}) {
  try {
    load_gltf(builder.write(name), params);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline bool has_warning(const LoadedScene& loaded, const std::string& part) {
  return std::any_of(loaded.warnings.begin(), loaded.warnings.end(),
                     [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

}  // namespace ivory
