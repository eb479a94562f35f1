// Kahan summation: `precise` forbids the compiler to simplify the compensation to zero.
struct CompensatedSum {
  float sum;
  float lost;  // what the last additions rounded away, to be subtracted from the next term
};

void add(inout CompensatedSum s, float value) {
  precise float term = value - s.lost;
  precise float total = s.sum + term;
  precise float kept = total - s.sum;
  precise float lost = kept - term;
  s.sum = total;
  s.lost = lost;
}
