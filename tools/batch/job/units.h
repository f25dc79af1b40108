// Numbers with units, as people write them into job files, to what the command line takes.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ivory {

// `text` as the option of that type (its type name in the help: METRES, DEGREES, SECONDS, MINUTES, BYTES, COUNT, a box
// or a place X,Y,Z) takes it: "25 cm" is "0.25" for METRES, "0 m, 1.5 m, 0 m" is "0,1.5,0", "12 GiB" is "12884901888".
// Text without a unit stays as it is. Nothing for a unit that does not belong to the type, which `units_for()` names.
std::optional<std::string> without_units(std::string_view text, std::string_view type_name);

// "mm, cm, m, km"; empty for a type without units.
std::string units_for(std::string_view type_name);

}  // namespace ivory
