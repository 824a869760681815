// The looks of the file's cells. Include after cell_looks.h.
CellLooks cell_looks() {
    CellLooks looks;
    looks.cells = CellView(cell_begins[0], cell_level);
    looks.color = ValueView(cell_begins[1]);
    looks.back = ValueView(cell_begins[2]);
    looks.emission = ValueView(cell_begins[3]);
    looks.back_emission = ValueView(cell_begins[4]);
    looks.has = cell_has;
    looks.padding = 0;
    return looks;
}

// What the cell that was hit looks like from the eye; clay where there is no colour.
CellLook seen_look(DagView dag, GridHit hit, vec3 towards) {
    CellLook look;
    look.albedo = clay();
    look.emission = vec3(0.0);
    if (cell_level == 0) return look;
    look = cell_look(dag, cell_looks(), hit.path, dag.depth - hit.height, towards);
    if (look.albedo.x < 0.0) look.albedo = clay();
    return look;
}
