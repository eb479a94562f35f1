// Rotations. The C++ twin of moveBy's formula is host/swarm (moveBy).

mat3 rotationOf(vec4 q) {  // unit quaternion (x, y, z, w)
  vec3 d = 2.0 * q.xyz;
  vec3 w = q.w * d;
  float xx = q.x * d.x, yy = q.y * d.y, zz = q.z * d.z;
  float xy = q.x * d.y, xz = q.x * d.z, yz = q.y * d.z;
  return mat3(1.0 - yy - zz, xy + w.z, xz - w.y,  // first column
              xy - w.z, 1.0 - xx - zz, yz + w.x,
              xz + w.y, yz - w.x, 1.0 - xx - yy);
}

// Quaternion whose imaginary part is v; lengths over 1 are shortened to 1.
vec4 quaternionOf(vec3 v) {
  float square = dot(v, v);
  if (square > 1.0) return vec4(v * inversesqrt(square), 0.0);
  return vec4(v, sqrt(1.0 - square));
}
