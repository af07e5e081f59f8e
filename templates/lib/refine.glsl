// A bracket of a root: `above` > 0 is the value at `outer`, `below` <= 0 that at `inner`. The value of an end that stays
// is made to count for less (Anderson and Bjorck 1973), and where three looks did not halve the bracket, its middle is next.
struct Bracket {
    float outer;
    float above;
    float inner;
    float below;
    float width;  // as it was three looks ago
    float looks;  // since then; -1 where the middle is next
    float moved;  // the end that moved last: 1 outer, -1 inner, 0 none
};

Bracket bracket(float outer, float above, float inner, float below) {
    return Bracket(outer, above, inner, below, inner - outer, 0.0, 0.0);
}

// where to look next, between the ends
float look(Bracket b) {
    float share = b.looks < 0.0 ? 0.5 : b.above / max(b.above - b.below, 1e-30);
    return mix(b.outer, b.inner, clamp(share, 0.0, 1.0));
}

void narrow(inout Bracket b, float t, float value) {
    bool is_outer = value > 0.0, is_third = b.looks >= 2.0;
    float fall = 1.0 - value / (is_outer ? b.above : min(b.below, -1e-30));
    float weight = (is_outer ? 1.0 : -1.0) != b.moved ? 1.0 : fall > 0.0 ? fall : 0.5;
    b.outer = is_outer ? t : b.outer;
    b.inner = is_outer ? b.inner : t;
    b.above = is_outer ? value : b.above * weight;
    b.below = is_outer ? b.below * weight : value;
    b.moved = is_outer ? 1.0 : -1.0;
    b.looks = !is_third ? max(b.looks, 0.0) + 1.0 : b.inner - b.outer > 0.5 * b.width ? -1.0 : 0.0;
    b.width = is_third ? b.inner - b.outer : b.width;
}
