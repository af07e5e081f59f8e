{# plain: whether it is regula falsi as published, without the two safeguards #}
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

// the bracket after a look at t
Bracket narrowed(Bracket b, float t, float value) {
    bool is_outer = value > 0.0, is_third = b.looks >= 2.0, is_slow = b.inner - b.outer > 0.5 * b.width;
    float moved = is_outer ? 1.0 : -1.0, fall = 1.0 - value / (is_outer ? b.above : min(b.below, -1e-30));
{% if plain %}
    float weight = 1.0;
{% else %}
    float weight = moved != b.moved ? 1.0 : fall > 0.0 ? fall : 0.5;
{% endif %}
    vec2 ends = is_outer ? vec2(t, b.inner) : vec2(b.outer, t);
    vec2 values = is_outer ? vec2(value, b.below * weight) : vec2(b.above * weight, value);
{% if plain %}
    float looks = 0.0;
{% else %}
    float looks = !is_third ? max(b.looks, 0.0) + 1.0 : is_slow ? -1.0 : 0.0;
{% endif %}
    return Bracket(ends.x, values.x, ends.y, values.y, is_third ? ends.y - ends.x : b.width, looks, moved);
}
