// What a bake to an asked-for error says about the error that it reached: measured, at points that had no part in any
// choice. It stands in the asset's metadata.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "grid/base/metadata.h"

namespace ivory {

// Errors are shares: RMS of the error of E over the points ÷ mean E there, as `measure` says in words.
struct Certificate {
  double target = 0;  // asked for; 0: nothing was asked for, the error is only measured
  double error = 0;   // measured, the truth's own noise taken off
  double low = 0;     // 95 % confidence interval of `error`
  double high = 0;
  std::string measure;                  // over what, against what: "E at 1000 lit surface points, path-traced"
  std::map<std::string, double> parts;  // what it is made of, shares likewise: "noise", "resolution", ...
};

// Takes it out of what is no longer the asset that it was measured of.
void remove_certificate(Metadata& metadata);

// Stores it under keys that begin with "certificate_".
void keep_certificate(const Certificate& certificate, Metadata& metadata);

// The certificate that the metadata holds; nothing where it holds none, or one without target, error, low or high.
std::optional<Certificate> find_certificate(const Metadata& metadata);

}  // namespace ivory
