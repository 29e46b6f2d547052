//! The text of C structures from their descriptions.

/// Description of a C structure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Structure {
    /// Name of the type, e.g. `protean_robot_state`.
    pub name: String,
    /// Comment before it; may be empty.
    pub doc: String,
    /// Size (bytes).
    pub size: usize,
    /// Members in order.
    pub members: Vec<Member>,
}

/// A member of a [`Structure`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// Name.
    pub name: String,
    /// Declaration without the semicolon, e.g. `double covariance[9]`.
    pub declaration: String,
    /// Comment behind it.
    pub doc: String,
    /// Offset from the start of the structure (bytes).
    pub offset: usize,
}

/// Declaration of the macro `PROTEAN_ASSERT`, which the checks of [`Structure::write`] use: C99 has no static assertion.
pub const ASSERT: &str = "\
#ifdef __cplusplus
#define PROTEAN_ASSERT(name, condition) static_assert(condition, #name)
#else
#define PROTEAN_ASSERT(name, condition) typedef char name[(condition) ? 1 : -1]
#endif
";

impl Structure {
    /// Returns the declaration of the type, which precedes all uses of its name.
    pub fn declaration(&self) -> String {
        format!("typedef struct {0} {0};\n", self.name)
    }

    /// Appends the type, and the checks of its size and offsets.
    pub fn write(&self, text: &mut String) {
        if !self.doc.is_empty() {
            *text += &format!("/* {} */\n", self.doc);
        }
        *text += &format!("struct {} {{\n", self.name);
        for member in &self.members {
            *text += &format!("    {};", member.declaration);
            if !member.doc.is_empty() {
                *text += &format!(" /* {} */", member.doc);
            }
            text.push('\n');
        }
        *text += "};\n";
        let name = &self.name;
        let mut check = |what: &str, condition: &str, value: usize| {
            *text += &format!("PROTEAN_ASSERT({name}_{what}, {condition} == {value});\n");
        };
        check("size", &format!("sizeof({name})"), self.size);
        for Member {
            name: member,
            offset,
            ..
        } in &self.members
        {
            let condition = format!("offsetof({name}, {member})");
            check(&format!("at_{member}"), &condition, *offset);
        }
        text.push('\n');
    }
}
