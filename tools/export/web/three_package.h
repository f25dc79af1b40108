// three.js, which a page needs a copy of: its npm package as the user has it.
#pragma once

#include <string>
#include <vector>

namespace ivory {

struct ThreePackage {
  std::string folder;   // of the package
  std::string version;  // "0.187.0"
};

// The package at `path`, or, where that is empty, node_modules/three of the working folder or of one above it, as
// Node.js looks for it. Throws Error, which says how to get it, where there is none or one that knows no
// LightProbeGridWebGL.
ThreePackage find_three(const std::string& path);

// Copies the modules of the package that are named and all that they import, with its licence, into `to` (a folder that
// is there), each under its path in the package. Answers the bytes. Throws Error where they cannot be read or written.
std::size_t copy_three(const ThreePackage& package, const std::vector<std::string>& modules, const std::string& to);

}  // namespace ivory
