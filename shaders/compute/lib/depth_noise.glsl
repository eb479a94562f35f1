// Standard deviation of a depth camera's depth, metres: a floor and a growth with the square of the distance, after
// Nguyen, Izadi and Lovell 2012 (Modeling Kinect sensor noise).
float depthNoise(float noise_floor, float growth, float depth) {
  float beyond = max(depth - 0.4, 0.0);
  return noise_floor + growth * beyond * beyond;
}

// Of the noise and what the depths of a surface are off together, which grows with the square of the distance.
float depthVariance(float noise, float bias_growth, float depth) {
  float bias = bias_growth * depth * depth;
  return noise * noise + bias * bias;
}
