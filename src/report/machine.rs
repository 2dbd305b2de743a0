//! What the figures were measured on.

use std::fmt;

/// The machine and the program, as far as times depend on them.
#[derive(Clone, Debug)]
pub struct Machine {
    /// The processor's name, where the system tells it.
    pub processor: String,
    /// Threads that it runs at once.
    pub cores: usize,
    /// Threads that pictures are rendered on.
    pub threads: usize,
    /// Vector instructions that Glassbox knows and the processor has.
    pub vectors: String,
    /// The operating system and the architecture.
    pub system: String,
    /// What the program was built with.
    pub build: String,
    /// Tasks that wanted to run over the last minute when the report began, where the system tells it.
    pub load: Option<f64>,
}

impl Machine {
    /// This one.
    pub fn here() -> Self {
        let features = [
            ("editor", cfg!(feature = "editor")),
            ("view", cfg!(feature = "view")),
            ("wayland", cfg!(feature = "wayland")),
        ];
        let on: Vec<&str> = features.iter().filter(|f| f.1).map(|f| f.0).collect();
        let profile = if cfg!(debug_assertions) {
            "with debug assertions"
        } else {
            "optimised"
        };
        Self {
            processor: processor().unwrap_or_else(|| "unknown processor".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            threads: rayon::current_num_threads(),
            vectors: vectors().join(", "),
            system: format!("{} on {}", std::env::consts::OS, std::env::consts::ARCH),
            build: format!(
                "Glassbox {}, {}, {profile}, features: {}",
                env!("CARGO_PKG_VERSION"),
                env!("GLASSBOX_COMPILER"),
                if on.is_empty() {
                    "none".to_owned()
                } else {
                    on.join(", ")
                },
            ),
            load: load(),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{}, {} threads at once, {} used, {}; {}; {}",
            self.processor, self.cores, self.threads, self.vectors, self.system, self.build
        )?;
        match self.load {
            Some(load) => write!(f, "; load {load:.1} when it began"),
            None => Ok(()),
        }
    }
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let of = |key: &str| {
        let line = text.lines().find(|line| line.starts_with(key))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let name = of("model name")?;
    // Virtual machines often hide the model behind the maker's name; family and model number tell more.
    match (of("cpu family"), of("model\t")) {
        (Some(family), Some(model)) => Some(format!("{name} (family {family}, model {model})")),
        _ => Some(name),
    }
}

fn load() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

#[cfg(target_arch = "x86_64")]
fn vectors() -> Vec<&'static str> {
    let known = [
        ("AVX2", is_x86_feature_detected!("avx2")),
        ("FMA", is_x86_feature_detected!("fma")),
        ("AVX-512VL", is_x86_feature_detected!("avx512vl")),
    ];
    let found: Vec<&str> = known.iter().filter(|v| v.1).map(|v| v.0).collect();
    if found.is_empty() {
        vec!["SSE2"]
    } else {
        found
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn vectors() -> Vec<&'static str> {
    vec!["no x86 vectors"]
}
