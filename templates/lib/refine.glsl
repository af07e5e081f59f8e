// A bracket of a root: `above` > 0 is the value at `outer`, `below` <= 0 that at `inner`. Where one end stays, its value
// is made to count for less (Anderson & Bjorck 1973); where three looks did not halve the bracket, the middle is next.
struct Bracket {
    float outer;
    float above;
    float inner;
    float below;
    float width;  // as it was when `looks` was 0
    float looks;  // 0, 1, 2; below 0 where the middle is next
    float side;   // the end that was moved last: 1 outer, -1 inner, 0 none
};

Bracket bracket(float outer, float above, float inner, float below) {
    return Bracket(outer, above, inner, below, inner - outer, 0.0, 0.0);
}

// where to look next: always between the ends
float look(Bracket b) {
    float part = b.looks < 0.0 ? 0.5 : b.above / max(b.above - b.below, 1e-30);
    return mix(b.outer, b.inner, clamp(part, 0.0, 1.0));
}

void narrow(inout Bracket b, float t, float value) {
    float old = value > 0.0 ? b.above : b.below;
    float now = value > 0.0 ? 1.0 : -1.0;
    float less = 1.0 - value / (old == 0.0 ? -1.0 : old);
    float weight = now == b.side ? (less > 0.0 ? less : 0.5) : 1.0;
    b.outer = value > 0.0 ? t : b.outer;
    b.inner = value > 0.0 ? b.inner : t;
    b.above = value > 0.0 ? value : b.above * weight;
    b.below = value > 0.0 ? b.below * weight : value;
    b.side = now;
    bool is_third = b.looks >= 2.0, is_slow = b.inner - b.outer > 0.5 * b.width;
    b.looks = is_third ? (is_slow ? -1.0 : 0.0) : max(b.looks, 0.0) + 1.0;
    b.width = is_third || b.looks == 1.0 && now == 0.0 ? b.inner - b.outer : b.width;
}
