// All cells are clay: in place of the looks of the file's cells.
struct CellLook {
    vec3 albedo;
    vec3 emission;
};

CellLook seen_look(DagView dag, GridHit hit, vec3 towards) {
    CellLook look;
    look.albedo = clay();
    look.emission = vec3(0.0);
    return look;
}
