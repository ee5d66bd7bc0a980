//! Scenes from Wavefront OBJ.
//!
//! Polygons count, with positions, texture coordinates, normals and colours of their vertices (linear), and materials from
//! MTL files ([`super::mtl`]). Texture coordinates are turned to v down. A line that cannot be read costs that line, and
//! what names it; so does a picture or an MTL file. All of it is said.

use super::assembly::{Assembly, Piece};
use super::mtl::{Entry, Remarks, Shelf};
use super::mtl_pictures::{Made, Pictures};
use super::named::{self, Beside, MOST};
use super::obj_model::{Face, Model, NONE, Run, no_memory};
use super::polygon::triangulate;
use super::text::{LinesOf, shortened, shown_path, tally};
use super::{AlphaMode, Emission, Material, Scene};
use crate::error::{Error, Result};
use crate::warning::Warning;
use glam::{DAffine3, DVec2, DVec3};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Base colour of what has no material, or a material without a colour.
const GREY: f64 = 0.8;

/// Vertices after which a piece is handed over, so that few are held twice; those of two pieces are not shared.
const PIECE: usize = 1 << 16;

/// Reads `bytes`, the content of `path`; materials and pictures are looked for beside it.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Scene> {
    let file = path.display().to_string();
    let mut model = Model::read(&file, bytes)?;
    let mut scene = Scene::default();
    let mut beside = Beside::new(path);
    let (shelf, mut libraries) = read_libraries(path, &model.libraries, &mut beside, &mut scene);

    let uses = resolve(&mut model, &shelf, &mut scene.warnings, &file);
    let mut pictures = Pictures::default();
    let is_used: BTreeSet<usize> = uses.iter().copied().flatten().collect();
    let mut looks = Vec::with_capacity(shelf.entries.len());
    for (i, entry) in shelf.entries.iter().enumerate() {
        let (library, remarks) = &mut libraries[entry.library];
        // What no face shows needs no picture.
        let made = if is_used.contains(&i) {
            pictures.make(entry, library, &mut beside, &mut scene.textures, remarks)
        } else {
            Made::default()
        };
        looks.push(Shown::new(entry, made));
        scene.materials.push(material(entry, made));
    }

    let mut builder = Builder::new(&file, bytes, &mut model, &mut scene.materials, looks);
    builder.faces(&uses)?;
    let (assembly, untextured) = (builder.assembly, builder.untextured);
    let no_material = builder.default;
    for (i, (entry, look)) in shelf.entries.iter().zip(&builder.looks).enumerate() {
        if entry.look.emission != DVec3::ZERO {
            let emission = Emission::plain(entry.look.emission);
            let shown = look.plain.into_iter().chain([i as u32]);
            scene
                .emissions
                .extend(shown.map(|index| (index, emission.clone())));
        }
    }

    scene.no_material = no_material;
    let mesh = assembly.finish(&file, &mut scene.warnings);
    (scene.mesh, scene.parts) = mesh.map_err(|error| match model.faults.earliest() {
        Some((problem, lines)) => Error::input(
            format!("{file}:{}", lines.first.first().unwrap_or(&0)),
            format!("{problem} (`{}`), and no triangle is left", lines.example),
            "repair the line, or export the file again",
        ),
        None => error,
    })?;
    let warnings = &mut scene.warnings;
    warnings.extend(model.faults.into_warnings(&file));
    if !model.statements.is_empty() {
        warnings.push(Warning::UnreadStatements {
            file: file.clone(),
            statements: model.statements,
        });
    }
    if untextured > 0 {
        warnings.push(Warning::UntexturedFaces {
            file: file.clone(),
            count: untextured,
        });
    }
    for (library, remarks) in libraries {
        let library = library.display().to_string();
        warnings.extend(remarks.faults.into_warnings(&library));
        if !remarks.left_out.is_empty() {
            warnings.push(Warning::IgnoredMaterialProperties {
                file: library,
                properties: remarks.left_out,
            });
        }
    }
    warnings.extend(pictures.into_warnings(&file));
    warnings.extend(beside.into_warnings());
    Ok(scene)
}

/// The material of an entry with the texture that its pictures make.
fn material(entry: &Entry, made: Made) -> Material {
    // Where only a picture is named, it is not dimmed.
    let absent = if made.colored { 1.0 } else { GREY };
    Material {
        name: entry.name.clone(),
        base_color: entry.look.diffuse.unwrap_or(DVec3::splat(absent)),
        texture: made.texture,
        ..plain(entry.look.opacity, made.pierced)
    }
}

/// A material of that opacity without name, colour and texture.
fn plain(alpha: f64, pierced: bool) -> Material {
    Material {
        name: "default".into(),
        base_color: DVec3::splat(GREY),
        alpha,
        texture: None,
        alpha_mode: if alpha < 1.0 || pierced {
            AlphaMode::Blend
        } else {
            AlphaMode::Opaque
        },
        pane: None,
    }
}

/// Reads all that the `mtllib` lines name; the files with what was odd about them.
fn read_libraries(
    scene_file: &Path,
    written: &[String],
    beside: &mut Beside,
    scene: &mut Scene,
) -> (Shelf, Vec<(PathBuf, Remarks)>) {
    let file = scene_file.display().to_string();
    let mut shelf = Shelf::default();
    let mut libraries: Vec<(PathBuf, Remarks)> = Vec::new();
    let mut seen = BTreeSet::new();
    let mut missing = Vec::new();
    for line in written {
        // A name with spaces, or several names.
        let names = if beside.find(scene_file, line).exists() {
            vec![line.clone()]
        } else {
            several(line)
        };
        for name in names {
            let path = beside.find(scene_file, &name);
            if !seen.insert(path.clone()) {
                continue;
            }
            let shown = shown_path(&path.display().to_string());
            let remedy = "put the MTL file where the OBJ file names it";
            let read = named::read(&path)
                .map_err(|problem| (problem, remedy.to_owned()))
                .and_then(|bytes| {
                    shelf
                        .read(&shown, &bytes, libraries.len())
                        .map_err(|error| (error.problem(), error.remedy()))
                });
            match read {
                Ok(remarks) => libraries.push((path, remarks)),
                Err(problem) => missing.push(problem),
            }
        }
    }
    let more = missing.len().saturating_sub(MOST);
    let rest = (more > 0).then(|| (format!("{more} more files cannot be read"), String::new()));
    for (problem, remedy) in missing.into_iter().take(MOST).chain(rest) {
        scene.warnings.push(Warning::MissingMaterials {
            file: file.clone(),
            problem,
            remedy,
        });
    }
    (shelf, libraries)
}

/// The names of a `mtllib` line: each ends in `.mtl`, or is a word.
fn several(line: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut open = String::new();
    for word in line.split_inclusive(char::is_whitespace) {
        open.push_str(word);
        let word = word.trim().trim_matches('"');
        if word.to_ascii_lowercase().ends_with(".mtl") {
            names.push(open.trim().to_owned());
            open.clear();
        }
    }
    names.extend(open.split_whitespace().map(str::to_owned));
    names
}

/// For each name of a material the one that it means; those that mean none are told of with their faces.
fn resolve(
    model: &mut Model,
    shelf: &Shelf,
    warnings: &mut Vec<Warning>,
    file: &str,
) -> Vec<Option<usize>> {
    let mut uses = Vec::with_capacity(model.names.len());
    for (name, line) in &model.names {
        let found = shelf.find(name);
        if found.is_some_and(|(_, exact)| !exact) {
            model.faults.add(
                "a material by that name is there only without regard to case or comment, and is taken",
                *line,
                || shortened(name),
            );
        }
        uses.push(found.map(|(index, _)| index));
    }
    let mut unknown = BTreeMap::new();
    let mut start = 0;
    for run in &model.runs {
        let name = &model.names[run.name].0;
        if uses[run.name].is_none() && !name.is_empty() {
            tally(&mut unknown, name, run.end - start);
        }
        start = run.end;
    }
    if !unknown.is_empty() {
        warnings.push(Warning::UnknownMaterials {
            file: file.to_owned(),
            materials: unknown,
        });
    }
    uses
}

/// How faces show a material.
struct Shown {
    /// Base colour without a texture.
    color: DVec3,
    /// How the texture lies: a coordinate is scaled, then moved.
    scale: DVec2,
    offset: DVec2,
    /// The same material without a texture, for faces that have no texture coordinates.
    plain: Option<u32>,
}

impl Shown {
    fn new(entry: &Entry, made: Made) -> Self {
        let map = entry.look.diffuse_map.as_ref();
        let map = map.or(entry.look.opacity_map.as_ref());
        let map = map.filter(|_| made.texture.is_some());
        Shown {
            color: entry.look.diffuse.unwrap_or(DVec3::splat(GREY)),
            scale: map.map_or(DVec2::ONE, |map| map.scale),
            offset: map.map_or(DVec2::ZERO, |map| map.offset),
            plain: None,
        }
    }
}

/// From faces to pieces.
struct Builder<'a> {
    file: &'a str,
    bytes: &'a [u8],
    model: &'a mut Model,
    materials: &'a mut Vec<Material>,
    looks: Vec<Shown>,
    /// The material of faces without one.
    default: Option<u32>,
    assembly: Assembly,
    piece: Piece,
    /// Position, texture coordinate and normal of the piece's vertices.
    keys: Vec<[u32; 3]>,
    /// For each position the piece's last vertex there, if `keys` agrees; for each vertex the one before it there.
    first: Vec<u32>,
    next: Vec<u32>,
    untextured: usize,
}

impl<'a> Builder<'a> {
    fn new(
        file: &'a str,
        bytes: &'a [u8],
        model: &'a mut Model,
        materials: &'a mut Vec<Material>,
        looks: Vec<Shown>,
    ) -> Self {
        Builder {
            file,
            bytes,
            model,
            materials,
            looks,
            default: None,
            assembly: Assembly::default(),
            piece: Piece::default(),
            keys: Vec::new(),
            first: Vec::new(),
            next: Vec::new(),
            untextured: 0,
        }
    }

    /// `uses` has the material of each name.
    fn faces(&mut self, uses: &[Option<usize>]) -> Result<()> {
        let positions = self.model.positions.len();
        let room = self.first.try_reserve_exact(positions);
        room.map_err(|_| no_memory())?;
        self.first.resize(positions, NONE);
        let mut corners = Vec::new();
        let mut vertices = Vec::new();
        let (mut face, mut corner) = (0, 0);
        let mut last = None;
        for run in 0..self.model.runs.len() {
            let Run { name, object, end } = self.model.runs[run];
            if last.replace(object) != Some(object) {
                self.hand_over()?;
                self.assembly.begin_part(self.model.objects[object].clone());
            }
            for face in face..end {
                let Face { corners: n, line } = self.model.faces[face];
                corners.clear();
                corners.extend_from_slice(&self.model.corners[corner..corner + n as usize]);
                corner += n as usize;
                if !self.check(&mut corners, line) {
                    continue;
                }
                let textured = corners[0][1] != NONE;
                let material = self.material(uses[name], textured);
                if material != self.piece.material || self.keys.len() >= PIECE {
                    self.hand_over()?;
                    self.piece.material = material;
                }
                let look = uses[name].map(|i| (self.looks[i].scale, self.looks[i].offset));
                let (scale, offset) = look.unwrap_or((DVec2::ONE, DVec2::ZERO));
                vertices.clear();
                for &key in &corners {
                    vertices.push(self.vertex(key, scale, offset));
                }
                let clean =
                    triangulate(&self.piece.positions, &vertices, &mut self.piece.triangles);
                if !clean {
                    self.fault(
                        "a face that crosses itself or has no area; cut into triangles as well as it goes",
                        line,
                    );
                }
            }
            face = end;
        }
        self.hand_over()
    }

    fn fault(&mut self, problem: &'static str, line: u32) {
        let (file, bytes) = (self.file, self.bytes);
        let number = line as usize;
        self.model.faults.add(problem, number, || {
            let mut lines = LinesOf::new(file, bytes).into_iter().flatten();
            let line = lines.find(|line| line.number == number);
            line.map_or(String::new(), |line| line.shown())
        });
    }

    /// Whether a face can stand. Texture coordinates and normals that not all of its corners have are taken away.
    fn check(&mut self, corners: &mut [[u32; 3]], line: u32) -> bool {
        let model = &self.model;
        let position = |c: &[u32; 3]| model.positions.get(c[0] as usize);
        let problem = if corners.iter().any(|c| position(c).is_none()) {
            Some("a face names a vertex that is not there; left out")
        } else if corners
            .iter()
            .any(|c| position(c).is_some_and(|p| !p.is_finite()))
        {
            Some("a face of a vertex that cannot be read; left out")
        } else {
            None
        };
        if let Some(problem) = problem {
            self.fault(problem, line);
            return false;
        }
        let uv = |i: u32| model.uvs.get(i as usize).is_some_and(|uv| uv.is_finite());
        let normal = |i: u32| model.normals.get(i as usize).is_some_and(|n| n.is_finite());
        let whole = [
            corners.iter().all(|c| uv(c[1])),
            corners.iter().all(|c| normal(c[2])),
        ];
        let problems = [
            "a corner without a texture coordinate that is there; the face has none",
            "a corner without a normal that is there; the face has its own",
        ];
        for (kind, (whole, problem)) in whole.into_iter().zip(problems).enumerate() {
            if !whole && corners.iter().any(|c| c[kind + 1] != NONE) {
                corners.iter_mut().for_each(|c| c[kind + 1] = NONE);
                self.fault(problem, line);
            }
        }
        true
    }

    /// The number of the material that a face shows.
    fn material(&mut self, entry: Option<usize>, textured: bool) -> u32 {
        let Some(entry) = entry else {
            return *self.default.get_or_insert_with(|| {
                self.materials.push(plain(1.0, false));
                self.materials.len() as u32 - 1
            });
        };
        if textured || self.materials[entry].texture.is_none() {
            return entry as u32;
        }
        self.untextured += 1;
        let Shown {
            color, plain: bare, ..
        } = &mut self.looks[entry];
        *bare.get_or_insert_with(|| {
            let material = &self.materials[entry];
            let bare = Material {
                name: format!("{} without texture", material.name),
                base_color: *color,
                ..plain(material.alpha, false)
            };
            self.materials.push(bare);
            self.materials.len() as u32 - 1
        })
    }

    /// The number in the piece of the vertex that a corner means.
    fn vertex(&mut self, key: [u32; 3], scale: DVec2, offset: DVec2) -> u32 {
        // Looking farther back than this costs more than a vertex too many.
        const FARTHEST: usize = 32;
        let [v, vt, vn] = key.map(|i| i as usize);
        // What is left of an earlier piece is not of this position, or not there.
        let is_here =
            |i: u32, keys: &[[u32; 3]]| keys.get(i as usize).is_some_and(|k| k[0] == key[0]);
        let head = self.first[v];
        let head = if is_here(head, &self.keys) {
            head
        } else {
            NONE
        };
        let mut candidate = head;
        for _ in 0..FARTHEST {
            match self.keys.get(candidate as usize) {
                None => break,
                Some(known) if *known == key => return candidate,
                Some(_) => candidate = self.next[candidate as usize],
            }
        }
        let index = self.keys.len() as u32;
        self.next.push(head);
        self.first[v] = index;
        self.keys.push(key);
        let model = &self.model;
        self.piece.positions.push(model.positions[v]);
        let normal = model.normals.get(vn).copied().unwrap_or(DVec3::ZERO);
        self.piece.normals.push(normal);
        let uv = model.uvs.get(vt).map(|&uv| uv * scale + offset);
        let uv = uv.map_or(DVec2::ZERO, |uv| DVec2::new(uv.x, 1.0 - uv.y));
        self.piece.uvs.push(uv);
        if let Some(&color) = model.colors.get(v) {
            self.piece.colors.push(color);
            if color.w < 1.0 {
                self.materials[self.piece.material as usize].alpha_mode = AlphaMode::Blend;
            }
        }
        index
    }

    fn hand_over(&mut self) -> Result<()> {
        let file = self.file;
        self.assembly
            .add(&self.piece, DAffine3::IDENTITY, &|| file.to_owned())?;
        self.keys.clear();
        self.next.clear();
        self.piece.positions.clear();
        self.piece.normals.clear();
        self.piece.uvs.clear();
        self.piece.colors.clear();
        self.piece.triangles.clear();
        Ok(())
    }
}
