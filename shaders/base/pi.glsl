// For all other files, which include it.
const float ivory_pi = 3.14159265358979;
