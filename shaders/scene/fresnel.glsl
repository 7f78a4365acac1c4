// SPDX-License-Identifier: MIT
#ifndef SHEAF_FRESNEL_GLSL
#define SHEAF_FRESNEL_GLSL
vec3 schlick(vec3 f0, float x) {
  float m = clamp(1.0 - x, 0.0, 1.0);
  float m2 = m * m;
  return f0 + (1.0 - f0) * (m2 * m2 * m);
}

// Unpolarised reflectance of a smooth interface, from n1 to n2; 1 in total internal reflection.
float fresnel(float cos1, float n1, float n2) {
  float eta = n1 / n2;
  float sin2 = eta * eta * max(0.0, 1.0 - cos1 * cos1);
  if (sin2 >= 1.0) return 1.0;
  float cos2 = sqrt(1.0 - sin2);
  float s = (n1 * cos1 - n2 * cos2) / (n1 * cos1 + n2 * cos2);
  float p = (n2 * cos1 - n1 * cos2) / (n2 * cos1 + n1 * cos2);
  return 0.5 * (s * s + p * p);
}
#endif
