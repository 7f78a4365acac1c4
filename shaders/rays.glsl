// SPDX-License-Identifier: MIT
// Reading rays. RAYS(list, word, slot) addresses a structure of arrays of `frame.capacity` slots.
layout(scalar, set = 0, binding = ROLE_FRAME) readonly buffer Block_frame { Frame frame; };

#define RAYS(list, word, slot) list[(word) * frame.capacity + (slot)]

struct Ray {
  vec3 origin;
  vec3 direction;
  float tmin;
  float tmax;
};

#define LOAD_RAY(list, slot)                                                                                     \
  Ray(vec3(RAYS(list, RAY_ORIGIN, slot), RAYS(list, RAY_ORIGIN + 1, slot), RAYS(list, RAY_ORIGIN + 2, slot)),    \
      vec3(RAYS(list, RAY_DIRECTION, slot), RAYS(list, RAY_DIRECTION + 1, slot), RAYS(list, RAY_DIRECTION + 2, slot)), \
      RAYS(list, RAY_TMIN, slot), RAYS(list, RAY_TMAX, slot))

#define STORE_RAY(list, slot, o, d, t0, t1, w)          \
  RAYS(list, RAY_ORIGIN, slot) = (o).x;                 \
  RAYS(list, RAY_ORIGIN + 1, slot) = (o).y;             \
  RAYS(list, RAY_ORIGIN + 2, slot) = (o).z;             \
  RAYS(list, RAY_DIRECTION, slot) = (d).x;              \
  RAYS(list, RAY_DIRECTION + 1, slot) = (d).y;          \
  RAYS(list, RAY_DIRECTION + 2, slot) = (d).z;          \
  RAYS(list, RAY_TMIN, slot) = (t0);                    \
  RAYS(list, RAY_TMAX, slot) = (t1);                    \
  RAYS(list, RAY_WEIGHT, slot) = (w).x;                 \
  RAYS(list, RAY_WEIGHT + 1, slot) = (w).y;             \
  RAYS(list, RAY_WEIGHT + 2, slot) = (w).z
