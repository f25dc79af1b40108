// --report: what a reader will show, before anyone ships it.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "grid/export/survey/survey.h"
#include "grid/export/survey/thin_walls.h"

namespace ivory {

struct ReaderReport {
  std::string target;  // its name
  std::string grid;    // its file's name
  V3d anchor_m{0, 0, 0};
  bool by_rays =
      false;  // what is known is guarded by rays in the scene, on all its surfaces; else by planes, on theirs
  ReaderSurvey survey;
  std::vector<ThinWall> walls;
};

nlohmann::ordered_json to_json(const ReaderReport& report);
// Whole lines for people.
std::string report_text(const ReaderReport& report);
// A page that needs no file beside it: the same, and plans of where.
std::string report_html(const ReaderReport& report);

}  // namespace ivory
