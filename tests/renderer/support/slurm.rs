//! A Slurm of this machine alone: authentication, controller and node on the loopback interface, all their files in a folder.
//!
//! Everything that it starts has the configuration's path in its environment. By that it is found again and ended, when the
//! test is over, however it ends.

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// The longest wait for a daemon.
const START: Duration = Duration::from_secs(8);

/// A running Slurm.
pub(crate) struct Cluster {
    folder: PathBuf,
    daemons: Vec<Child>,
}

impl Cluster {
    /// Starts Slurm in a new folder; where that cannot be, says why, and that the test is left out.
    pub(crate) fn start(folder: &Path) -> Option<Cluster> {
        let lacks = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol"]
            .into_iter()
            .find(|name| {
                let found = Command::new("sh")
                    .args(["-c", &format!("command -v {name}")])
                    .output();
                !found.is_ok_and(|output| output.status.success())
            });
        let root = Command::new("id").arg("-u").output();
        let root = root.is_ok_and(|output| output.stdout.trim_ascii() == b"0");
        if let Some(name) = lacks {
            eprintln!(
                "left out: there is no {name} (apt-get install munge slurmctld slurmd slurm-client)"
            );
            return None;
        }
        if !root {
            eprintln!("left out: only root can start Slurm's node");
            return None;
        }
        fs::create_dir(folder).expect("a folder");
        let mut cluster = Cluster {
            folder: folder.into(),
            daemons: Vec::new(),
        };
        if let Err(reason) = cluster.up() {
            eprintln!("left out: Slurm does not start: {reason}");
            return None;
        }
        Some(cluster)
    }

    /// Starts the daemons, and waits until the node takes jobs.
    fn up(&mut self) -> Result<(), String> {
        let text = self.folder.display().to_string();
        self.configure(&text).map_err(|error| error.to_string())?;
        let munge = [
            "--foreground".into(),
            "--force".into(),
            format!("--key-file={text}/munge.key"),
            format!("--socket={text}/munge.socket"),
            format!("--pid-file={text}/munge.pid"),
            format!("--log-file={text}/munge.log"),
            format!("--seed-file={text}/munge.seed"),
        ];
        self.spawn("munged", &munge)?;
        let socket = self.folder.join("munge.socket");
        wait("munged", START, || socket.exists())?;
        self.spawn("slurmctld", &["-D".into(), "-c".into()])?;
        self.spawn("slurmd", &["-D".into(), "-N".into(), host()])?;
        wait("the node", START, || {
            let told = self.run("sinfo", &["--noheader", "-o", "%T"]);
            String::from_utf8_lossy(&told.stdout).trim() == "idle"
        })
    }

    /// Writes key and configuration, with ports that are free now.
    fn configure(&self, text: &str) -> std::io::Result<()> {
        use std::os::unix::fs::PermissionsExt;
        let key = self.folder.join("munge.key");
        let random: Vec<u8> = (0..1024_u32)
            .map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8)
            .collect();
        fs::write(&key, random)?;
        fs::set_permissions(&key, fs::Permissions::from_mode(0o600))?;
        fs::create_dir(self.folder.join("state"))?;
        fs::create_dir(self.folder.join("spool"))?;
        let free = [
            TcpListener::bind("127.0.0.1:0")?,
            TcpListener::bind("127.0.0.1:0")?,
        ];
        let [controller, node] = free.map(|port| port.local_addr().map_or(0, |at| at.port()));
        let host = host();
        let lines = format!(
            "ClusterName=test\nSlurmctldHost={host}(127.0.0.1)\nSlurmctldPort={controller}\nSlurmdPort={node}\n\
             SlurmUser=root\nSlurmdUser=root\nAuthType=auth/munge\nAuthInfo=socket={text}/munge.socket\n\
             CommunicationParameters=NoCtldInAddrAny,NoInAddrAny\n\
             StateSaveLocation={text}/state\nSlurmdSpoolDir={text}/spool\n\
             SlurmctldPidFile={text}/controller.pid\nSlurmdPidFile={text}/node.pid\n\
             SlurmctldLogFile={text}/controller.log\nSlurmdLogFile={text}/node.log\n\
             ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSwitchType=switch/none\nMpiDefault=none\n\
             SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\nKillWait=1\n\
             SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0\n\
             SlurmdParameters=config_overrides\n\
             NodeName={host} NodeAddr=127.0.0.1 CPUs=8 State=UNKNOWN\n\
             PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n"
        );
        fs::write(self.configuration(), lines)
    }

    fn configuration(&self) -> PathBuf {
        self.folder.join("slurm.conf")
    }

    fn spawn(&mut self, name: &str, args: &[String]) -> Result<(), String> {
        let log = fs::File::create(self.folder.join(format!("{name}.out")));
        let log = log.map_err(|error| error.to_string())?;
        let again = log.try_clone().map_err(|error| error.to_string())?;
        let mut command = Command::new(name);
        command.args(args).env("SLURM_CONF", self.configuration());
        command.stdin(Stdio::null()).stdout(log).stderr(again);
        let child = command
            .spawn()
            .map_err(|error| format!("{name}: {error}"))?;
        self.daemons.push(child);
        Ok(())
    }

    /// A command that talks to this Slurm.
    pub(crate) fn command(&self, name: &str) -> Command {
        let mut command = Command::new(name);
        command.env("SLURM_CONF", self.configuration());
        command
    }

    /// Runs a command of Slurm's.
    pub(crate) fn run(&self, name: &str, args: &[&str]) -> Output {
        let output = self.command(name).args(args).output();
        output.expect("the command starts")
    }

    /// The states of all jobs and tasks that are not over, with the reasons for which they wait, a line each.
    pub(crate) fn queue(&self) -> String {
        let told = self.run("squeue", &["--noheader", "-o", "%i %T %r"]);
        match told.status.success() {
            true => String::from_utf8_lossy(&told.stdout).into_owned(),
            false => String::from_utf8_lossy(&told.stderr).into_owned(),
        }
    }

    /// Lets tasks that were queued again start after two seconds, in place of two minutes, and says whether there were any. In
    /// the second in which a task was ended, Slurm's node does not take it again.
    pub(crate) fn hurry(&self) -> bool {
        let queue = self.queue();
        let again = queue.lines().filter(|line| line.ends_with("BeginTime"));
        let tasks: Vec<&str> = again.filter_map(|line| line.split(' ').next()).collect();
        if !tasks.is_empty() {
            std::thread::sleep(Duration::from_secs(2));
        }
        for task in &tasks {
            let task = format!("JobId={task}");
            self.run("scontrol", &["update", &task, "StartTime=now"]);
        }
        !tasks.is_empty()
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        // What belongs to it goes twice: something may have started something in between.
        let mark = format!("SLURM_CONF={}", self.configuration().display());
        for _ in 0..2 {
            let ours = processes().filter(|pid| has(*pid, &mark));
            ours.for_each(|pid| end(pid, "KILL"));
        }
        for daemon in &mut self.daemons {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

/// Waits until something holds.
pub(crate) fn wait(what: &str, most: Duration, holds: impl Fn() -> bool) -> Result<(), String> {
    let start = Instant::now();
    while !holds() {
        if start.elapsed() > most {
            return Err(format!("{what} is not there after {} s", most.as_secs()));
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Ok(())
}

/// The numbers of all processes.
fn processes() -> impl Iterator<Item = u32> {
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok())
}

/// Whether a process started with a variable of this value, `NAME=value`.
fn has(pid: u32, variable: &str) -> bool {
    let environment = fs::read(format!("/proc/{pid}/environ")).unwrap_or_default();
    environment
        .split(|byte| *byte == 0)
        .any(|known| known == variable.as_bytes())
}

/// The program's process that works in a folder and started with a variable.
pub(crate) fn running(folder: &Path, variable: &str) -> Option<u32> {
    let folder = fs::canonicalize(folder).ok()?;
    let program = Path::new(env!("CARGO_BIN_EXE_sweeplight"));
    processes().find(|pid| {
        let link = |name: &str| fs::read_link(format!("/proc/{pid}/{name}")).unwrap_or_default();
        link("exe") == program && link("cwd") == folder && has(*pid, variable)
    })
}

/// Sends a signal to a process.
pub(crate) fn end(pid: u32, signal: &str) {
    let _ = Command::new("kill")
        .args(["-s", signal, &pid.to_string()])
        .output();
}

/// The machine's name, as Slurm shortens it.
fn host() -> String {
    let host = sweeplight::io::claim::host();
    host.split('.').next().unwrap_or(&host).into()
}
