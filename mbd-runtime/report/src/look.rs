//! How the lines of a figure are told apart: width and dash first (they survive a black-and-white printer), colour second.

/// The look of one series. Colours are those of Okabe and Ito, which colour-blind readers can tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Wide and pale: lies under the others, so that two equal curves both stay visible.
    Band,
    /// Thin, solid, dark.
    Thin,
    /// Dashed.
    Dashed,
    /// Dotted.
    Dotted,
    /// Dash and dot.
    DashDot,
    /// Medium, solid.
    Solid,
    /// Short dashes.
    ShortDash,
    /// Long dashes.
    LongDash,
}

struct Stroke {
    light: &'static str,
    dark: &'static str,
    width: f64,
    dash: &'static str,
}

impl Look {
    /// All looks, in the order in which a figure hands them out.
    pub const ALL: [Look; 8] = [
        Look::Band,
        Look::Thin,
        Look::Dashed,
        Look::Dotted,
        Look::DashDot,
        Look::Solid,
        Look::ShortDash,
        Look::LongDash,
    ];

    /// The look of the series with this index; the list repeats.
    #[must_use]
    pub fn of(index: usize) -> Look {
        Look::ALL[index % Look::ALL.len()]
    }

    /// The name of the style class in the SVG.
    pub(super) fn class(self) -> String {
        format!("mbd-{self:?}")
    }

    fn stroke(self) -> Stroke {
        let (light, dark, width, dash) = match self {
            Look::Band => ("#7ab8e8", "#35729f", 4.0, ""),
            Look::Thin => ("#000000", "#f2f2f2", 1.1, ""),
            Look::Dashed => ("#d55e00", "#ff8a3c", 1.7, "8 4"),
            Look::Dotted => ("#009e73", "#2fd0a2", 2.2, "1 4"),
            Look::DashDot => ("#aa3f8c", "#e58cc9", 1.6, "10 3 2 3"),
            Look::Solid => ("#c08400", "#f0b429", 2.2, ""),
            Look::ShortDash => ("#0072b2", "#6cb8ff", 1.5, "3 2.5"),
            Look::LongDash => ("#6b6b6b", "#b0b0b0", 2.0, "16 5"),
        };
        Stroke {
            light,
            dark,
            width,
            dash,
        }
    }
}

/// The style sheet of every figure: light by itself and on paper, dark on a dark screen.
pub(super) fn style_sheet() -> String {
    let mut light = String::from(
        ".mbd-curves *{vector-effect:non-scaling-stroke}.mbd-ground{fill:#fff}.mbd-grid{stroke:#dcdcdc;stroke-width:.7}.mbd-minor{stroke:#eee;stroke-width:.6}\
         .mbd-frame{stroke:#444;stroke-width:1;fill:none}.mbd-level{stroke:#444;stroke-width:.9;stroke-dasharray:2 3}\
         .mbd-text{fill:#111;font-family:Helvetica,Arial,\"DejaVu Sans\",sans-serif}.mbd-series{fill:none;stroke-linejoin:round;stroke-linecap:butt}\
         .mbd-halo{stroke:#fff;stroke-width:3;stroke-linejoin:round;paint-order:stroke}\
         .mbd-body{stroke:#1a1a1a;stroke-width:2.6;stroke-linejoin:round;stroke-linecap:round;fill:#56b4e9;fill-opacity:.25}\
         .mbd-solid{stroke:#1a1a1a;stroke-width:1.3;stroke-linejoin:round;fill:#56b4e9;fill-opacity:.25}.mbd-rim{stroke:#1a1a1a;stroke-width:.8;stroke-linejoin:round;fill:none}\
         .mbd-rope{stroke:#0072b2;stroke-width:1.3}\
         .mbd-slack{stroke:#0072b2;stroke-width:1.3;stroke-dasharray:2 4}.mbd-joint{stroke:#1a1a1a;stroke-width:1.4;fill:#fff}.mbd-pivot{stroke:#1a1a1a;stroke-width:1.4;fill:#bbb}\
         .mbd-dot{fill:#1a1a1a}.mbd-rail{stroke:#6b6b6b;stroke-width:1.2;stroke-dasharray:1.5 3}",
    );
    let mut dark = String::from(
        ".mbd-ground{fill:#16181c}.mbd-grid{stroke:#34383f}.mbd-minor{stroke:#25282e}.mbd-frame{stroke:#aaa}\
         .mbd-level{stroke:#aaa}.mbd-text{fill:#e8e8e8}.mbd-halo{stroke:#16181c}.mbd-body,.mbd-solid,.mbd-rim{stroke:#e8e8e8}.mbd-rope{stroke:#6cb8ff}.mbd-slack{stroke:#6cb8ff}\
         .mbd-joint{stroke:#e8e8e8;fill:#16181c}.mbd-pivot{stroke:#e8e8e8;fill:#555}.mbd-dot{fill:#e8e8e8}.mbd-rail{stroke:#b0b0b0}",
    );
    for look in Look::ALL {
        let class = look.class();
        let stroke = look.stroke();
        let dash = match stroke.dash {
            "" => String::new(),
            dash => format!(";stroke-dasharray:{dash}"),
        };
        let cap = if look == Look::Dotted {
            ";stroke-linecap:round"
        } else {
            ""
        };
        light += &format!(
            ".{class}{{stroke:{};stroke-width:{}{dash}{cap}}}.{class}-mark{{stroke:{};stroke-width:1.3;fill:#fff}}",
            stroke.light, stroke.width, stroke.light
        );
        dark += &format!(
            ".{class}{{stroke:{}}}.{class}-mark{{stroke:{};fill:#16181c}}",
            stroke.dark, stroke.dark
        );
    }
    light += ".mbd-dots{stroke-linecap:round;stroke-width:3;stroke-dasharray:none;stroke-opacity:.6}.mbd-shade0,.mbd-shade1,.mbd-shade2{fill:#0072b2;fill-opacity:.14}.mbd-shade1{fill-opacity:.24}.mbd-shade2{fill-opacity:.4}";
    dark += ".mbd-shade0,.mbd-shade1,.mbd-shade2{fill:#6cb8ff}";
    format!("{light}@media screen and (prefers-color-scheme:dark){{{dark}}}")
}
