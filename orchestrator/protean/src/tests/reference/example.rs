//! The tables of types made up for it.

use parameters::{above, at_least};
use schemars::{JsonSchema, SchemaGenerator};
use serde::{Deserialize, Serialize};

use super::sections::Reference;

/// A robot.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(default)]
struct Robot {
    /// Name.
    name: String,
    /// First arm.
    arm: Arm,
    /// Other arm, a longer one.
    other_arm: Arm,
    /// Camera; none if absent.
    camera: Option<Camera>,
    /// Way of driving.
    drive: Drive,
}

/// A gripper arm.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
struct Arm {
    /// Length of all links.
    #[schemars(transform = above(0).unit("m"))]
    length: f64,
    /// Number of joints.
    #[schemars(transform = at_least(1))]
    joints: u32,
}

#[derive(Serialize, Deserialize, JsonSchema)]
struct Camera {
    /// Pixels of a row.
    pixels: u32,
}

#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Drive {
    /// It has none.
    None,
    /// On wheels.
    Wheels {
        /// Radius of each.
        #[schemars(transform = above(0).unit("m"))]
        radius: f64,
    },
}

impl Default for Arm {
    fn default() -> Self {
        Self {
            length: 0.5,
            joints: 6,
        }
    }
}

impl Default for Robot {
    fn default() -> Self {
        Self {
            name: "r2".to_owned(),
            arm: Arm::default(),
            other_arm: Arm {
                length: 0.7,
                ..Arm::default()
            },
            camera: None,
            drive: Drive::None,
        }
    }
}

#[test]
fn keys_are_in_the_order_of_declaration_and_a_table_of_two_places_has_one_section() {
    let markdown = Reference::of(&[("`robot`", SchemaGenerator::subschema_for::<Robot>)]);
    let want = "
## `robot`

A robot.

| key | type | default | range | unit | meaning |
|---|---|---|---|---|---|
| `name` | text | `\"r2\"` |  |  | Name. |
| `arm` | [`arm`](#arm) |  |  |  | First arm. |
| `other_arm` | [`arm`](#arm) | `{ length = 0.7 }` |  |  | Other arm, a longer one. |
| `camera` | table | – |  |  | Camera; none if absent. |
| `camera.pixels` | whole number | required | ≥ 0 |  | Pixels of a row. |
| `drive` | `none`, `wheels` | `\"none\"` |  |  | Way of driving. `none`: It has none. `wheels`: On wheels. |
| `drive.wheels.radius` | number | required | > 0 | m | Radius of each. |

## `arm`

A gripper arm.

| key | type | default | range | unit | meaning |
|---|---|---|---|---|---|
| `length` | number | `0.5` | > 0 | m | Length of all links. |
| `joints` | whole number | `6` | ≥ 1 |  | Number of joints. |
";
    assert_eq!(markdown, want);
}

#[test]
fn a_type_with_a_section_is_referred_to() {
    let markdown = Reference::of(&[
        ("`robot`", SchemaGenerator::subschema_for::<Robot>),
        ("Cameras", SchemaGenerator::subschema_for::<Camera>),
    ]);
    assert!(markdown.contains("| `camera` | [Cameras](#cameras) | – |"));
    assert!(!markdown.contains("camera.pixels"), "{markdown}");
}
