//! Options from elsewhere than the command line: a file, a preset, a layout.
//!
//! They become arguments before the user's own, and clap reads them all: it alone knows names, values and conflicts.

use super::Arguments;
use anyhow::Context;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, CommandFactory, FromArgMatches, value_parser};
use quadmosaic::options::{Preset, Setting, layout, preset};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Value};

/// The arguments that name other options.
#[derive(Args)]
#[command(next_help_heading = "Options together")]
pub struct ConfigArguments {
    /// The options for a purpose; others override them, each one
    #[arg(long, value_parser = presets())]
    preset: Option<Preset>,
    /// Options from a TOML file, as points = 6000
    ///
    /// Options have their long names: points = 6000, quads = "all", strict = true; those that may be given many times take lists. They
    /// override a preset, and the command line overrides them; there --strict=false takes back a flag. Paths begin in the current
    /// folder
    #[arg(long, value_name = "FILE.toml")]
    config: Option<PathBuf>,
    /// Print the options that result, as a file for --config; mesh nothing
    #[arg(long)]
    print_config: bool,
}

/// The names of presets, with their options.
fn presets() -> impl TypedValueParser<Value = Preset> {
    let told = |&(name, value): &Setting| format!("--{name} {value}");
    let value = |preset: Preset| {
        let settings: Vec<String> = preset.settings().iter().map(told).collect();
        PossibleValue::new(preset.name()).help(format!("{}: {}", preset.purpose(), settings.join(" ")))
    };
    PossibleValuesParser::new(Preset::ALL.map(value)).try_map(|name| preset(&name))
}

/// Names of arguments in clap.
const CONFIG: &str = "config";
const PRESET: &str = "preset";
const LAYOUT: &str = "layout";
const PRINT: &str = "print_config";

/// What the arguments ask for.
pub enum Request {
    Run(Arguments),
    /// To print this.
    Print(String),
}

/// Parses arguments, the program's name first, completed by the file, the preset and the layout that they name.
///
/// # Errors
/// Wrong usage, also where help is asked for; a file that cannot be read.
pub fn parse(arguments: &[OsString]) -> anyhow::Result<Request> {
    let plain = Arguments::command().mut_subcommands(with_negative_numbers);
    match plain.clone().try_get_matches_from(arguments) {
        Err(help) if !help.use_stderr() => return Err(help.into()),
        _ => {}
    }
    let command = plain.clone().mut_subcommands(switchable);
    let glance = command.clone().ignore_errors(true).try_get_matches_from(arguments)?;
    let named = glance.subcommand().and_then(|(name, given)| Some((plain.find_subcommand(name)?, given)));
    let Some((subcommand, given)) = named.filter(|(subcommand, _)| is_configurable(subcommand)) else {
        return run(command, arguments);
    };
    let mut completion = Completion::new(subcommand, given);
    completion.lay_out();
    if let Some(path) = given.get_one::<PathBuf>(CONFIG) {
        completion.add(read(path, &command, subcommand)?);
        completion.lay_out();
    }
    if let Some(Ok(preset)) = completion.value(PRESET).as_deref().map(preset) {
        completion.add(settings(subcommand, preset.settings(), &format!("preset {}", preset.name())));
        completion.lay_out();
    }
    let (start, end) = arguments.split_at(2);
    let all: Vec<OsString> = start.iter().cloned().chain(completion.arguments()).chain(end.iter().cloned()).collect();
    let name = subcommand.get_name();
    if given.get_one(PRINT) != Some(&true) {
        let matches = command.clone().try_get_matches_from(&all);
        // What is wrong with the user's own arguments is told without those that complete them.
        let told = |error| command.try_get_matches_from(arguments).err().unwrap_or(error);
        let matches = matches.map_err(told)?;
        let mut arguments = Arguments::from_arg_matches(&matches)?;
        if let (super::Command::Mesh(mesh), Some(matches)) = (&mut arguments.command, matches.subcommand_matches(name))
        {
            mesh.options = completion.resulting(matches);
        }
        return Ok(Request::Run(arguments));
    }
    let optional = command.mut_subcommand(name, |subcommand| subcommand.mut_args(|arg| arg.required(false)));
    let matches = optional.try_get_matches_from(&all)?;
    let matches = matches.subcommand_matches(name).unwrap_or(given);
    Ok(Request::Print(completion.resulting(matches).iter().map(Resulting::printed).collect()))
}

/// The same subcommand, whose values may be negative numbers: what is wrong with them is told.
fn with_negative_numbers(subcommand: Command) -> Command {
    subcommand.mut_args(|arg| {
        let takes_values = arg.get_action().takes_values();
        if takes_values { arg.allow_negative_numbers(true) } else { arg }
    })
}

fn run(command: Command, arguments: &[OsString]) -> anyhow::Result<Request> {
    Ok(Request::Run(Arguments::from_arg_matches(&command.try_get_matches_from(arguments)?)?))
}

fn is_configurable(subcommand: &Command) -> bool {
    subcommand.get_arguments().any(|arg| arg.get_id() == CONFIG)
}

/// The same subcommand, whose flags can be taken back, as by `--strict=false`.
fn switchable(subcommand: Command) -> Command {
    if !is_configurable(&subcommand) {
        return subcommand;
    }
    subcommand.mut_args(|arg| match arg.get_action() {
        ArgAction::SetTrue => arg
            .action(ArgAction::Set)
            .num_args(0..=1)
            .require_equals(true)
            .value_parser(value_parser!(bool))
            .default_missing_value("true")
            .default_value("false"),
        _ => arg,
    })
}

/// The options that a file may set, and their long names.
fn options(subcommand: &Command) -> impl Iterator<Item = (&Arg, &str)> {
    let named = subcommand.get_arguments().filter_map(|arg| Some((arg, arg.get_long()?)));
    named.filter(|(arg, _)| ![CONFIG, PRINT].contains(&arg.get_id().as_str()))
}

fn is_flag(arg: &Arg) -> bool {
    matches!(arg.get_action(), ArgAction::SetTrue)
}

/// An option with its values.
struct Given<'a> {
    arg: &'a Arg,
    name: &'a str,
    values: Vec<String>,
    /// Where it is given.
    origin: String,
}

impl Given<'_> {
    /// Whether it is a flag that is not set.
    fn is_off(&self) -> bool {
        is_flag(self.arg) && self.values == ["false"]
    }

    fn arguments(&self) -> impl Iterator<Item = OsString> {
        let values = self.values.iter().filter(|_| !self.is_off());
        values.map(|value| format!("--{}={value}", self.name).into())
    }
}

/// The options that complete the command line.
struct Completion<'a> {
    subcommand: &'a Command,
    /// The command line's.
    command_line: &'a ArgMatches,
    given: Vec<Given<'a>>,
}

impl<'a> Completion<'a> {
    fn new(subcommand: &'a Command, command_line: &'a ArgMatches) -> Self {
        Self { subcommand, command_line, given: Vec::new() }
    }

    fn is_on_command_line(&self, arg: &Arg) -> bool {
        self.command_line.value_source(arg.get_id().as_str()) == Some(ValueSource::CommandLine)
    }

    /// Adds options, but for those that are given before, and those that one given before excludes.
    fn add(&mut self, options: Vec<Given<'a>>) {
        let typed = self.subcommand.get_arguments().filter(|arg| self.is_on_command_line(arg));
        let before: Vec<(&Arg, bool)> =
            typed.map(|arg| (arg, false)).chain(self.given.iter().map(|given| (given.arg, given.is_off()))).collect();
        let excludes = |one: &Arg, other: &Arg| {
            let excluded = self.subcommand.get_arg_conflicts_with(one);
            excluded.iter().any(|arg| arg.get_id() == other.get_id())
        };
        let is_free = |given: &Given| {
            before.iter().all(|&(arg, is_off)| {
                let is_excluded = !is_off && (excludes(arg, given.arg) || excludes(given.arg, arg));
                arg.get_id() != given.arg.get_id() && !is_excluded
            })
        };
        let free: Vec<Given> = options.into_iter().filter(is_free).collect();
        self.given.extend(free);
    }

    /// Adds the options of the layout, where one is given by now; what is added later does not override them.
    fn lay_out(&mut self) {
        if let Some(Ok(layout)) = self.value(LAYOUT).as_deref().map(layout) {
            self.add(settings(self.subcommand, layout.settings(), &format!("layout {}", layout.name())));
        }
    }

    /// The value of an option, as text.
    fn value(&self, name: &str) -> Option<String> {
        let typed = self.command_line.get_raw(name).and_then(|mut values| values.next());
        let given = self.given.iter().find(|given| given.name == name);
        typed.map(|value| value.to_string_lossy().into_owned()).or_else(|| given?.values.first().cloned())
    }

    fn arguments(&self) -> impl Iterator<Item = OsString> {
        self.given.iter().flat_map(Given::arguments)
    }

    /// All options that have a value.
    fn resulting(&self, all: &ArgMatches) -> Vec<Resulting> {
        let mut resulting = Vec::new();
        for (arg, name) in options(self.subcommand) {
            let id = arg.get_id().as_str();
            let Some(values) = all.get_raw(id) else { continue };
            let values: Vec<String> = values.map(|value| value.to_string_lossy().into_owned()).collect();
            let value = match (arg.get_action(), values.as_slice()) {
                (ArgAction::Append, values) => Value::from(values.to_vec()),
                (_, [value]) if is_flag(arg) => Value::from(value == "true"),
                (_, [value]) => number(value).unwrap_or_else(|| Value::from(value.as_str())),
                _ => continue,
            };
            let before = self.given.iter().find(|given| given.name == name && !self.is_on_command_line(arg));
            let origin = match all.value_source(id) {
                Some(ValueSource::CommandLine) => before.map_or("command line", |given| given.origin.as_str()),
                _ => DEFAULT,
            };
            resulting.push(Resulting { name: name.to_owned(), value, origin: origin.to_owned() });
        }
        resulting
    }
}

/// The origin of options that are not given.
const DEFAULT: &str = "default";

/// An option that results from the command line, the file, the preset and the layout.
#[derive(Clone)]
pub struct Resulting {
    /// Its long name.
    pub name: String,
    pub value: Value,
    /// Where it is given.
    origin: String,
}

impl Resulting {
    /// Whether the user gave it, by itself.
    pub fn is_given(&self) -> bool {
        self.origin != DEFAULT && !self.origin.starts_with(PRESET)
    }

    /// A line of a file of options, one without effect as a comment.
    fn printed(&self) -> String {
        let Self { name, value, origin } = self;
        // The options of the preset are printed themselves.
        let hidden = if origin == DEFAULT || name == PRESET { "# " } else { "" };
        format!("{hidden}{name} = {value}  # {origin}\n")
    }
}

/// A number, where the text is as TOML writes it.
fn number(text: &str) -> Option<Value> {
    let whole = text.parse::<i64>().ok().map(Value::from);
    let real = text.parse::<f64>().ok().filter(|number| number.is_finite()).map(Value::from);
    whole.into_iter().chain(real).find(|number| number.to_string() == text)
}

/// The options that a name sets.
fn settings<'a>(subcommand: &'a Command, settings: &[Setting], origin: &str) -> Vec<Given<'a>> {
    let given = |&(name, value): &Setting| {
        let (arg, name) = options(subcommand).find(|(_, long)| *long == name)?;
        Some(Given { arg, name, values: vec![value.to_owned()], origin: origin.to_owned() })
    };
    settings.iter().filter_map(given).collect()
}

/// The options of a file.
fn read<'a>(path: &Path, command: &Command, subcommand: &'a Command) -> anyhow::Result<Vec<Given<'a>>> {
    let text = fs::read_to_string(path).with_context(|| format!("{} cannot be read", path.display()))?;
    let wrong = |start: usize, fault: &str| {
        let line = text[..start.min(text.len())].matches('\n').count() + 1;
        let message = format!("{}, line {line}: {fault}", path.display());
        Arguments::command().error(ErrorKind::ValueValidation, message)
    };
    let table = DeTable::parse(&text);
    let table = table.map_err(|error| wrong(error.span().unwrap_or_default().start, &lined(error.message())))?;
    let mut entries: Vec<_> = table.get_ref().iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);

    let mut arguments = vec![OsString::from("quadmosaic"), subcommand.get_name().into()];
    let mut all = Vec::new();
    for (key, value) in entries {
        let wrong = |fault: &str| wrong(key.span().start, fault);
        let known = options(subcommand).find(|(_, name)| name == key.get_ref());
        let (arg, name) = known.ok_or_else(|| wrong(&unknown(key.get_ref(), command, subcommand)))?;
        let values = values(arg, value.get_ref()).map_err(|fault| wrong(&format!("{name} {fault}")))?;
        let given = Given { arg, name, values, origin: path.display().to_string() };
        arguments.extend(given.arguments());
        expect_valid(command, &arguments).map_err(|fault| wrong(&fault))?;
        all.push(given);
    }
    Ok(all)
}

/// The texts of a value.
fn values(arg: &Arg, value: &DeValue) -> Result<Vec<String>, String> {
    let text = |value: &DeValue| match value {
        DeValue::Boolean(flag) if is_flag(arg) => Ok(flag.to_string()),
        DeValue::String(text) if !is_flag(arg) => Ok(text.to_string()),
        DeValue::Integer(number) if !is_flag(arg) => Ok(number.to_string()),
        DeValue::Float(number) if !is_flag(arg) => Ok(number.to_string()),
        other => {
            let wanted = if is_flag(arg) { "true or false" } else { "a number or a text in quotes" };
            Err(format!("takes {wanted}, not what TOML calls {}", other.type_str()))
        }
    };
    match value {
        DeValue::Array(list) if matches!(arg.get_action(), ArgAction::Append) => {
            list.iter().map(|value| text(Spanned::get_ref(value))).collect()
        }
        value => Ok(vec![text(value)?]),
    }
}

/// What to say of a key that is no option.
fn unknown(key: &str, command: &Command, subcommand: &Command) -> String {
    let argument = OsString::from(format!("--{key}"));
    let asked =
        command.clone().try_get_matches_from([OsString::from("quadmosaic"), subcommand.get_name().into(), argument]);
    let meant = asked.err().and_then(|error| match error.get(ContextKind::SuggestedArg) {
        Some(ContextValue::String(name)) => Some(format!("; perhaps {} is meant", name.trim_start_matches('-'))),
        _ => None,
    });
    format!("there is no option {key} for a file{}", meant.unwrap_or_default())
}

/// Refuses values and conflicts that clap refuses. What is missing, the command line may have.
fn expect_valid(command: &Command, arguments: &[OsString]) -> Result<(), String> {
    match command.clone().try_get_matches_from(arguments) {
        Err(error) if error.kind() != ErrorKind::MissingRequiredArgument => {
            let told = error.to_string();
            let first = told.split("\n\n").next().unwrap_or_default();
            Err(lined(first.trim_start_matches("error: ")))
        }
        _ => Ok(()),
    }
}

/// A text on one line.
fn lined(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
