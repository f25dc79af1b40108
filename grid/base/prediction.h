// What is predicted of a bake before it is made.
#pragma once

namespace ivory {

// A number to be expected, and what it should lie between; units are its user's.
struct Prediction {
  double low = 0;
  double expected = 0;
  double high = 0;
};

// A number that may turn out larger or smaller by a factor of at least 1.
inline Prediction within_factor(double expected, double factor) {
  return {expected / factor, expected, expected * factor};
}

}  // namespace ivory
