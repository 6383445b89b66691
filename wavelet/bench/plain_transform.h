// The transform as a textbook writes it, for comparison: 2,2 lifting in place, rows then columns,
// one sample at a time (compiled without vectorisation). Periodic, square, power-of-two size.
#pragma once

namespace wavefog::bench {

void plain_forward(float* map, float* line, int size, int levels);
void plain_inverse(float* map, float* line, int size, int levels);

}  // namespace wavefog::bench
