// The upper triangle of a symmetric matrix of `side` rows, stored row by row: place of (row, column), column >= row.
// For loops of constant length, as a loop from `row` on is not unrolled by every driver.
uint upperEntry(uint row, uint column, uint side) { return row * (2u * side - 1u - row) / 2u + column; }
