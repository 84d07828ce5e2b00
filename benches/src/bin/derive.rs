//! Derives one machine, for `derivation.py`: how long it takes, and its chain for other tools.
//!
//! In: `time`, `chain` or `expand`, and a machine: the path of a machine file, or (but for `expand`) `slides:12` or
//! `alternating:12` for a chain of so many joints. Out: for `chain` the chain as JSON; for `expand` the generated code, as a
//! build script gets it; for `time` seconds, links, error motions, terms, and the error at one
//! point, so that tools can be held against each other. The time is the least of several runs: for a file that of reading
//! and deriving, for a made chain, which no file can hold beyond nine axes, of deriving alone.

use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::time::{Duration, Instant};

use abbe_benches::chain::Chain;
use model_dsl::algebra::{Axis, Polynomial, Symbol};
use model_dsl::derivation;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::machine::{
    Along, Branch, Constant, Link, LinkKind, Machine, Motion, MotionKind, Orientation, Reference, Turned,
};
use model_dsl::source::{SourceFile, Span};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [what, which] = arguments.as_slice() else {
        return Err("give `time`, `chain` or `expand`, and a machine".into());
    };
    if what == "expand" {
        print!("{}", model_dsl::rust_for(which)?);
        return Ok(());
    }
    let made = which.split_once(':').map(|(series, count)| made(series, count)).transpose()?;
    let text = if made.is_none() { fs::read_to_string(which)? } else { String::new() };
    let source = SourceFile::new(which.as_str(), text);
    let derive = || match &made {
        Some(machine) => Some(derivation::derive(machine, &mut Diagnostics::new())),
        None => model_dsl::compile(&source, &mut Diagnostics::new()).map(|compiled| compiled.equations),
    };
    let machine = match &made {
        Some(machine) => machine.clone(),
        None => model_dsl::machine::read(&source, &mut Diagnostics::new()).ok_or("not a machine file")?,
    };
    if what == "chain" {
        // Every motion of the machine, since which of them show is for the tools to find out.
        let motions: Vec<String> = machine.motions.iter().map(|motion| motion.name.clone()).collect();
        print!("{}", Chain::new(&machine, &motions)?.json());
        return Ok(());
    }
    let (seconds, equations) = timed(derive)?;
    let terms: usize =
        equations.rows.iter().map(|row| row.terms.iter().map(|term| term.arm.size()).sum::<usize>()).sum();
    let [x, y, z] = at_the_point(&equations, &machine);
    println!("{seconds:e} {} {} {terms} {x:e} {y:e} {z:e}", machine.links.len(), machine.motions.len());
    Ok(())
}

/// The least time of runs that take a second together, and at least one.
fn timed(derive: impl Fn() -> Option<Equations>) -> Result<(f64, Equations), Box<dyn Error>> {
    let (begin, mut least) = (Instant::now(), f64::INFINITY);
    loop {
        let start = Instant::now();
        let equations = black_box(derive()).ok_or("the machine does not compile")?;
        least = least.min(start.elapsed().as_secs_f64());
        if begin.elapsed() > Duration::from_secs(1) {
            return Ok((least, equations));
        }
    }
}

/// The error where the k-th position is 0.3 + 0.1 k, the k-th constant 1.1 + 0.2 k and the k-th motion 0.001 (k + 1).
fn at_the_point(equations: &Equations, machine: &Machine) -> [f64; 3] {
    let place = |names: &mut dyn Iterator<Item = bool>| {
        names.enumerate().find(|(_, found)| *found).map_or(f64::NAN, |(place, _)| place as f64)
    };
    let value = |symbol: &Symbol| match symbol {
        Symbol::Position(name) | Symbol::Cos(name) | Symbol::Sin(name) => {
            let position: f64 =
                0.3 + 0.1 * place(&mut equations.axes.iter().map(|axis| axis.variable == *name));
            match symbol {
                Symbol::Cos(_) => position.cos(),
                Symbol::Sin(_) => position.sin(),
                _ => position,
            }
        }
        Symbol::Constant(name) => {
            1.1 + 0.2 * place(&mut machine.constants.iter().map(|constant| constant.name == *name))
        }
        Symbol::Travel(_) => 0.7,
        // Numbers in themselves are asked of nobody.
        Symbol::Motion(_) | Symbol::FixedCos(_) | Symbol::FixedSin(_) => f64::NAN,
    };
    Axis::ALL.map(|direction| {
        let terms = equations.row(direction).map(|row| row.terms.as_slice()).unwrap_or_default();
        let one = |term: &model_dsl::equations::Term| {
            let name = &equations.motions[term.motion].name;
            let number = place(&mut machine.motions.iter().map(|motion| motion.name == *name));
            term.arm.evaluate(value) * 0.001 * (number + 1.0)
        };
        terms.iter().map(one).sum()
    })
}

/// A chain of so many joints, all of them carrying the tool, each with six error motions and an offset of its own.
fn made(series: &str, count: &str) -> Result<Machine, Box<dyn Error>> {
    let count: u8 = count.parse()?;
    if !(1..=24).contains(&count) {
        return Err("a chain has 1 to 24 joints".into());
    }
    let kind = |joint: u8| {
        let letter = char::from(b'A' + joint);
        match (series, joint % 2) {
            ("slides", _) | ("alternating", 0) => Ok(LinkKind::Slide(letter)),
            ("alternating", _) => Ok(LinkKind::Rotary(letter)),
            _ => Err("the series are `slides` and `alternating`"),
        }
    };
    let mut machine = Machine {
        orientation: Orientation::Left,
        name: format!("{series}-{count}"),
        title: None,
        source: None,
        topology: None,
        sensitive: Axis::ALL.to_vec(),
        sensitive_spans: Vec::new(),
        relative: false,
        constants: Vec::new(),
        links: Vec::new(),
        motions: Vec::new(),
        motors: Vec::new(),
        drives: Vec::new(),
    };
    for joint in 0..count {
        // Slides and turns go round X, Y, Z, so that neighbours never share a direction.
        let along =
            Axis::ALL[usize::from(if series == "slides" { joint } else { joint / 2 + joint % 2 }) % 3];
        let origin =
            [Polynomial::zero(), Polynomial::zero(), offset(&mut machine, format!("L{}", joint + 1))];
        join(&mut machine, char::from(b'A' + joint).to_string(), kind(joint)?, along, origin);
    }
    let tip = ["Xt", "Yt", "Zt"].map(|name| offset(&mut machine, name.to_owned()));
    join(&mut machine, "tip".to_owned(), LinkKind::Tool, Axis::Z, tip);
    Ok(machine)
}

fn offset(machine: &mut Machine, name: String) -> Polynomial {
    let name: model_dsl::algebra::Name = name.into();
    machine.constants.push(Constant {
        name: name.clone(),
        meaning: None,
        default: None,
        direction: None,
        span: Span::new(0, 0),
    });
    Polynomial::symbol(Symbol::Constant(name))
}

fn join(machine: &mut Machine, id: String, kind: LinkKind, along: Axis, origin: [Polynomial; 3]) {
    if kind != LinkKind::Tool {
        let kinds = Axis::ALL.map(MotionKind::Linear).into_iter().chain(Axis::ALL.map(MotionKind::Angular));
        machine.motions.extend(kinds.map(|motion| Motion {
            name: format!("E{}{id}", motion.letter()),
            symbol: format!("E{}{id}", motion.letter()),
            symbol_span: None,
            link: machine.links.len(),
            kind: motion,
            motor: None,
            sign: 1,
            travel: None,
            rotates: false,
            counted_from: None,
            span: None,
        }));
    }
    let along = Along { axis: along, sign: 1 };
    let (branch, reference, span) = (Branch::Tool, Reference::Carriage, Span::new(0, 0));
    let turned = Turned::default();
    machine.links.push(Link { id, kind, branch, along, origin, turned, reference, corrects: true, span });
}
