// The page's own files, compiled in. Made by tools/cmake/EmbedFiles.cmake.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace ivory {

// Name and text: index.html, page.css, page.js.
const std::vector<std::pair<std::string, std::string>>& page_files();

}  // namespace ivory
