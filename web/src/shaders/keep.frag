flat in uvec4 filled;
layout(location = 0) out uvec4 slot;

void main() {
    slot = filled;
}
