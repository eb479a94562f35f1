// Normal equations summed over points by a workgroup that owns a part of them. The includer defines SUMS (numbers to sum),
// GROUP (invocations), UNKNOWNS, HESSIAN and GRADIENT (where their entries begin among the sums), and names the output `sums`.
#include "shaders/compute/lib/compensated_sum.glsl"
#include "shaders/compute/lib/upper_triangle.glsl"

// Whether a lane compensates its sums: where it adds a handful of terms there is nothing to lose, and half of its registers
// to win.
layout(constant_id = 1) const bool kCompensate = true;

void accumulate(inout CompensatedSum s, float value) {
  if (kCompensate) add(s, value);
  else s.sum += value;
}

// A lane's numbers, one more apart than there are lanes: a GPU's memory banks then answer all lanes at once.
const uint kLaneStride = GROUP + 1u;
shared float s_sums[SUMS * kLaneStride];

// Macros, as a function would copy the sums in and out, which not every driver sees through.
#define DECLARE_SUMS        \
  CompensatedSum sum[SUMS]; \
  [[unroll]] for (uint k = 0u; k < SUMS; ++k) sum[k] = CompensatedSum(0.0, 0.0);

// Adds a residual's J^T W J and J^T W r.
#define ADD_EQUATION(JACOBIAN, WEIGHT, RESIDUAL)                                                                  \
  [[unroll]] for (uint row = 0u; row < UNKNOWNS; ++row) {                                                         \
    float scaled = (WEIGHT) * JACOBIAN[row];                                                                      \
    [[unroll]] for (uint column = 0u; column < UNKNOWNS; ++column)                                                \
      if (column >= row) accumulate(sum[HESSIAN + upperEntry(row, column, UNKNOWNS)], scaled * JACOBIAN[column]); \
    accumulate(sum[GRADIENT + row], scaled * (RESIDUAL));                                                         \
  }

// Adds up the lanes, in their order, into SUMS numbers from sums[AT] on.
#define WRITE_SUMS(LANE, AT)                                                                               \
  [[unroll]] for (uint k = 0u; k < SUMS; ++k) s_sums[k * kLaneStride + (LANE)] = sum[k].sum - sum[k].lost; \
  barrier();                                                                                               \
  if ((LANE) >= SUMS) return;                                                                              \
  CompensatedSum all = CompensatedSum(0.0, 0.0);                                                           \
  for (uint i = 0u; i < GROUP; ++i) add(all, s_sums[(LANE) * kLaneStride + i]);                            \
  sums[(AT) + (LANE)] = all.sum - all.lost;
