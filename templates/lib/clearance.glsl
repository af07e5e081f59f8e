// How far along the normal a secondary ray starts: twice what the point at hand may be off the surface, `residual` the value
// there where that is more, but no more than half a pixel (Keinert 2014, section 3.3). A field that is flatter than a
// distance is off by more than it says.
float clearance(float residual, float steepness) {
    float off = min(abs(residual), cone.x + cone.y * travelled);
    return 2.0 * max(max(0.5 * {{ lift }}, 2.0 * tolerance(0.0)), off) / clamp(steepness, 0.05, 1.0);
}
