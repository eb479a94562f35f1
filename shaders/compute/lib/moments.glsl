// Moments of the depths of some pixels, and the plane through them. Kept around their own means, so that single precision
// does not cancel.
struct Moments {
  float n;      // pixels
  vec2 at;      // mean pixel
  float q;      // mean inverse depth
  float uu, uv, vv, qq;  // sums of products of deviations
  vec2 with_q;
};

Moments noMoments() { return Moments(0.0, vec2(0.0), 0.0, 0.0, 0.0, 0.0, 0.0, vec2(0.0)); }
Moments momentsOf(vec2 at, float q) { return Moments(1.0, at, q, 0.0, 0.0, 0.0, 0.0, vec2(0.0)); }
Moments unpacked(vec4 a, vec4 b, vec4 c) { return Moments(a.x, a.yz, a.w, b.x, b.y, b.z, b.w, c.xy); }

Moments merged(Moments a, Moments b) {
  if (b.n == 0.0) return a;
  float n = a.n + b.n, share = b.n / n, weight = a.n * share;
  vec2 d = b.at - a.at;
  float dq = b.q - a.q;
  return Moments(n, a.at + share * d, a.q + share * dq, a.uu + b.uu + weight * d.x * d.x, a.uv + b.uv + weight * d.x * d.y,
                 a.vv + b.vv + weight * d.y * d.y, a.qq + b.qq + weight * dq * dq, a.with_q + b.with_q + weight * dq * d);
}

// The inverse depth at a pixel is q + dot(slope, pixel - at).
struct Plane {
  vec2 slope;
  float squares;  // sum of squared deviations of the depths from it
  float det;
};

// Through at least four pixels that are not all in line.
Plane planeThrough(Moments m) {
  float det = m.uu * m.vv - m.uv * m.uv;
  vec2 slope = vec2(m.vv * m.with_q.x - m.uv * m.with_q.y, m.uu * m.with_q.y - m.uv * m.with_q.x) / det;
  return Plane(slope, max(m.qq - dot(slope, m.with_q), 0.0), det);
}

// Variance of the plane at a pixel, that of a single depth being 1.
float leverage(Moments m, Plane plane, vec2 pixel) {
  vec2 d = pixel - m.at;
  return 1.0 / m.n + (m.vv * d.x * d.x - 2.0 * m.uv * d.x * d.y + m.uu * d.y * d.y) / plane.det;
}
