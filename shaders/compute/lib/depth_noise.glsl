// Standard deviation of a depth camera's depth, metres: a floor and a growth with the square of the distance, after
// Nguyen, Izadi and Lovell 2012 (Modeling Kinect sensor noise).
float depthNoise(float noise_floor, float growth, float depth) {
  float beyond = max(depth - 0.4, 0.0);
  return noise_floor + growth * beyond * beyond;
}

// Inverse variance, 1 close to the camera.
float depthWeight(float noise_floor, float growth, float depth) {
  float relative = noise_floor / depthNoise(noise_floor, growth, depth);
  return relative * relative;
}
