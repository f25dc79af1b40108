// Pictures of a grid for a report: its light, its error, its noise, what leaks, and where its vertices stand, in views
// cut open.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tracer/bake/field/contract/certificate.h"
#include "tracer/core/camera.h"

namespace ivory {

struct ReportPicture {
  std::string title;  // "error"
  std::vector<std::uint8_t> png;
};

// A place in a picture, in pixels from its top left corner.
struct ReportMark {
  std::size_t place = 0;  // which of the certificate's worst
  float x = 0;
  float y = 0;
};

struct ReportView {
  std::string title;  // "from above, cut open"
  int width = 0;
  int height = 0;
  std::vector<ReportPicture> pictures;  // one of each kind that the view shows
  std::vector<ReportMark> marks;        // of the worst places that are seen
};

struct ReportScales {
  double off = 0;    // ends of the colours of the error and of what leaks: share of mean E
  double noise = 0;  // of the noise's
};

ReportScales report_scales(const FieldCertificate& certificate);

// From above, from the front and from the side, each cut open, and through the scene's first camera where it has one.
// Errors between the measured points are those of the nearest ones of about the same normal.
std::vector<ReportView> report_views(const LitScene& lit, const IrradianceGrid& grid,
                                     const FieldCertificate& certificate, const LookupParams& lookup);

}  // namespace ivory
