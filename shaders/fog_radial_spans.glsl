// How far apart the rows are that a look-up in an exponential profile reads (fog_radial_profile.glsl).
// Compiles as GLSL and as C++; the bound on what they leave out reads it too.

// A ray counts up to radial_top over its lowest point. One parabola of density serves radial_width there,
// and radial_widen more for each unit above.
#ifdef RADIAL_STEP
const float radial_top = 14.0f;
const float radial_width = 0.5f;
const float radial_widen = 0.3f;
// Above this the profile, 0.018, makes up for what the parabola errs between two rows.
const float radial_nearby = 4.0f;
#else
const float radial_top = 10.0f;
const float radial_width = 0.8f;
const float radial_widen = 0.5f;
#endif
// Second moments count in stretches that are at least this part of their far end's distance, times the
// profile's change over them at most this.
const float radial_curved_part = 1.0f / 40.0f;
const float radial_curved_change = 2.0f;
